// Coverage over cost of the plans on show, with a bar at the present cost.

const kMostPoints = 1200; // of a curve: more than its pixels would not show

// The points of a curve, thinned evenly in steps.
function curve_of(trail) {
  const stride = Math.max(1, Math.ceil(trail.nodes.length / kMostPoints));
  const points = [];
  for (let step = 0; step < trail.last; step += stride) points.push({ x: trail.costs[step], y: trail.worth(step) });
  points.push({ x: trail.costs[trail.last], y: trail.worth(trail.last) });
  return points;
}

class ProgressChart {
  constructor(world, trails) {
    Object.assign(this, { world, trails });
    const spans = trails.map((trail) => Math.max(trail.costs[trail.last], is_number(trail.budget) ? trail.budget : 0));
    this.most = Math.max(...spans) || 1;
    this.draw();
  }

  draw() {
    const measured = this.world.prizes ? 'prizes' : 'nodes';
    $('progress-heading').textContent = this.world.prizes ? 'Prize over cost' : 'Coverage over cost';
    this.chart = put_chart($('progress'), {
      type: 'line',
      data: { datasets: this.trails.flatMap((trail, i) => this.lines_of(trail, i)) },
      options: {
        parsing: false,
        interaction: { mode: 'nearest', axis: 'x', intersect: false },
        scales: {
          x: axis(`Cost${this.world.unit && `,${this.world.unit}`}`, { min: 0, max: this.most }),
          y: axis(`% of ${measured}`, { min: 0, max: 100, ticks: { stepSize: 25 } }),
        },
        plugins: {
          tooltip: { filter: ({ dataset }) => !dataset.bound, callbacks: { title: () => '', label: point_text } },
        },
        onResize: () => requestAnimationFrame(() => this.show(this.cost ?? 0)),
      },
    });
    this.draw_legend();
    const ends = this.trails.map((trail) => `${trail.policy} ends at ${fixed(trail.worth(trail.last))} %`);
    $('progress').setAttribute('aria-label', `Chart of ${measured} over cost: ${ends.join(', ')}.`);
  }

  lines_of(trail, i) {
    const colour = theme.get(`plan-${i}`);
    const curve = { label: trail.policy, data: curve_of(trail), borderWidth: 2, stepped: 'before' };
    const lines = [curve];
    const bound = trail.plan.upper_bound;
    if (is_number(bound)) {
      const data = [0, this.most].map((x) => ({ x, y: Math.min(bound, 100) }));
      lines.push({ bound: true, data, borderWidth: 1.5, borderDash: [6, 4] });
    }
    return lines.map((line) => ({ ...line, borderColor: colour }));
  }

  draw_legend() {
    const items = this.trails.flatMap((trail, i) => {
      const colour = theme.get(`plan-${i}`);
      const bound = trail.plan.upper_bound;
      const text = trail.plan.optimal ? 'no walk has more' : 'no walk can have more';
      return [
        key_item(colour, '', trail.policy),
        ...(is_number(bound) ? [key_item(colour, 'dashed', `${text}: ${fixed(bound)} %`)] : []),
      ];
    });
    $('progress-legend').replaceChildren(...items);
  }

  // Only the bar moves: the chart itself stays as it is.
  show(cost) {
    this.cost = cost;
    const { chartArea, scales } = this.chart;
    if (!chartArea) return;
    const cursor = $('cursor');
    cursor.style.top = `${chartArea.top}px`;
    cursor.style.height = `${chartArea.bottom - chartArea.top}px`;
    cursor.style.transform = `translateX(${scales.x.getPixelForValue(cost)}px)`;
  }
}

function point_text({ dataset, parsed }) {
  return `${dataset.label}: ${fixed(parsed.y)} % at cost ${plain(parsed.x)}`;
}
