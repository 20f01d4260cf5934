// What all charts share: colours of the theme, no animation, and marks that the library lacks.

// Draws over the bars of a horizontal chart, per value: marks [{x, shape}] with shapes dot, cross, line.
const marks_plugin = {
  id: 'marks',
  afterDatasetsDraw(chart) {
    const context = chart.ctx;
    chart.data.datasets.forEach((dataset, i) => {
      if (!dataset.marks || !chart.isDatasetVisible(i)) return;
      chart.getDatasetMeta(i).data.forEach((bar, k) => {
        for (const mark of dataset.marks[k] ?? []) {
          const x = chart.scales.x.getPixelForValue(mark.x);
          draw_chart_mark(context, mark, x, bar.y, bar.height, dataset.mark_colour);
        }
      });
    });
  },
};

function draw_chart_mark(context, { shape, size = 3.5 }, x, y, height, colour) {
  context.save();
  context.fillStyle = colour;
  context.strokeStyle = shape === 'dot' ? colour : theme.get('text');
  context.lineWidth = 1.75;
  context.beginPath();
  if (shape === 'dot') {
    context.arc(x, y, size, 0, 2 * Math.PI);
    context.fill();
  } else if (shape === 'cross') {
    context.moveTo(x - size, y - size);
    context.lineTo(x + size, y + size);
    context.moveTo(x + size, y - size);
    context.lineTo(x - size, y + size);
    context.stroke();
  } else if (shape === 'line') {
    context.moveTo(x, y - height / 2 - 1);
    context.lineTo(x, y + height / 2 + 1);
    context.stroke();
  } else {
    context.globalAlpha = 0.5;
    context.arc(x, y, size, 0, 2 * Math.PI);
    context.fill();
  }
  context.restore();
}

function set_up_charts() {
  Chart.register(marks_plugin);
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.plugins.legend.display = false;
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.elements.point.radius = 0;
  Chart.defaults.elements.point.hitRadius = 12;
  Chart.defaults.elements.line.borderJoinStyle = 'round';
}

function colour_charts() {
  Chart.defaults.color = theme.get('muted');
  Chart.defaults.borderColor = theme.get('line');
  Object.assign(Chart.defaults.plugins.tooltip, {
    backgroundColor: theme.get('surface'),
    titleColor: theme.get('text'),
    bodyColor: theme.get('text'),
    borderColor: theme.get('control-line'),
    borderWidth: 1,
    boxPadding: 4,
  });
}

// A linear or logarithmic axis.
function axis(title, more = {}) {
  const numbers = more.type === 'logarithmic' ? { callback: (value, i, ticks) => log_tick(value, ticks) } : {};
  return {
    type: 'linear',
    title: { display: Boolean(title), text: title },
    ...more,
    ticks: { maxRotation: 0, autoSkipPadding: 12, ...numbers, ...more.ticks },
  };
}

// Of a logarithmic axis: 1, 2 and 5 of each decade; all if it spans less than one decade.
function log_tick(value, ticks) {
  const digit = Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));
  const wide = ticks.length > 0 && ticks[ticks.length - 1].value / ticks[0].value > 10;
  return !wide || [1, 2, 5].includes(digit) ? significant(value) : '';
}

// Puts a chart on a canvas, in place of the one on it.
function put_chart(canvas, config) {
  Chart.getChart(canvas)?.destroy();
  return new Chart(canvas, config);
}

function key_item(colour, dash_name, ...content) {
  const key = element('span', { className: `key ${dash_name}` });
  key.style.color = colour;
  return element('li', {}, key, ...content);
}
