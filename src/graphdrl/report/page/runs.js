// Training curves: one chart per metric, all runs in it.

const kCounters = ['episode', 'round']; // what lines of a run are counted in
const kAmounts = ['steps', 'states']; // how much had been seen by then
const kMetricTitles = { coverage: 'coverage, %', visited_nodes: 'visited nodes' };
const kFirstSmoothing = 3; // percent of a run
const kMostSmoothing = 20;
const kLogSpan = 4; // a loss that spans more is first drawn on a logarithmic scale

// An exponential moving average, corrected for its start as Adam's moments are. It looks back over a percentage of the
// run, so that short and long runs are smoothed alike.
function smoothed(points, percent) {
  const share = past_share(points, percent);
  let average = 0;
  let weight = 0;
  return points.map(({ x, y }) => {
    average = share * average + (1 - share) * y;
    weight = share * weight + (1 - share);
    return { x, y: average / weight };
  });
}

// How much of a smoothed value is the past; 0 if the window is no longer than one value.
function past_share(points, percent) {
  return 1 - 1 / Math.max(1, (points.length * percent) / 100);
}

function read_run(run, index) {
  check(Array.isArray(run.lines), 'it has no lines');
  const lines = run.lines.filter((line) => line && typeof line === 'object');
  const has = (name) => lines.some((line) => is_number(line[name]));
  const counter = kCounters.find(has);
  check(lines.length === 0 || counter, `its lines have no ${kCounters.join(' or ')}`);
  const names = new Set(lines.flatMap(Object.keys));
  const metrics = [...names].filter((name) => !kCounters.includes(name) && !kAmounts.includes(name) && has(name));
  return { name: String(run.name ?? `Run ${index + 1}`), lines, counter, amount: kAmounts.find(has), metrics };
}

// The values of a metric, over the counter or over the amount; no point if either is missing.
function points_of(run, metric, over_amounts) {
  const key = over_amounts ? run.amount : run.counter;
  const whole = run.lines.filter((line) => is_number(line[key]) && is_number(line[metric]));
  return whole.map((line) => ({ x: line[key], y: line[metric] }));
}

class Runs {
  constructor() {
    this.runs = [];
    this.hidden = new Set(); // names
    this.log = new Map(); // metric: what the reader chose
    this.smoothing = kFirstSmoothing;
    this.over_amounts = false;
    theme.on_change(() => this.draw());
  }

  update(runs) {
    const text = JSON.stringify(runs);
    if (text === this.text) return;
    this.text = text;
    this.problems = element('div');
    this.runs = runs
      .map((run, i) => guarded(this.problems, `Run ${i + 1}`, () => read_run(run, i)))
      .filter((run) => run !== null);
    this.metrics = [...new Set(this.runs.flatMap((run) => run.metrics))];
    // With the same runs and metrics, the controls and charts stay: only the curves grow.
    const shape = JSON.stringify([this.runs.map((run) => [run.name, run.counter, run.amount]), this.metrics]);
    if (shape !== this.shape) this.build();
    this.shape = shape;
    this.draw();
  }

  build() {
    this.charts = new Map(this.metrics.map((metric) => [metric, this.build_chart(metric)]));
    this.table = table_box('Latest values');
    this.legend = element('ul', { className: 'legend' });
    $('runs-body').replaceChildren(
      this.problems,
      this.build_fields(),
      element('div', { role: 'group', 'aria-label': 'Runs shown' }, this.legend),
      element('div', { className: 'chart-grid' }, ...[...this.charts.values()].map(({ box }) => box)),
      this.table,
    );
  }

  build_fields() {
    const text = () => `${plain(this.smoothing, 1)} % of a run`;
    const shown = element('output', { textContent: text() });
    const scale = { min: 0, max: kMostSmoothing, step: 0.5, value: this.smoothing };
    const range = element('input', { type: 'range', id: 'smoothing', ...scale });
    range.addEventListener('input', () => {
      this.smoothing = Number(range.value);
      shown.textContent = text();
      this.draw_soon();
    });
    const over = element('select', { id: 'runs-over' });
    fill_select(over, [this.unit_names('counter'), this.unit_names('amount')], Number(this.over_amounts));
    over.addEventListener('change', () => {
      this.over_amounts = over.value === '1';
      this.draw();
    });
    const over_field = element('label', { hidden: !this.unit_names('amount') }, 'Over ', over);
    return element('div', { className: 'fields' }, element('label', {}, 'Smoothing ', range, shown), over_field);
  }

  unit_names(field) {
    const names = new Set(this.runs.map((run) => run[field]).filter(Boolean));
    return [...names].map((name) => name.replace(/s?$/, 's')).join(' or ');
  }

  build_chart(metric) {
    const title = kMetricTitles[metric] ?? metric.replaceAll('_', ' ');
    const canvas = element('canvas', { role: 'img' });
    const log = element('input', { type: 'checkbox' });
    log.addEventListener('change', () => {
      this.log.set(metric, log.checked);
      this.draw();
    });
    const box = element(
      'figure',
      { className: 'chart-box' },
      element('figcaption', {}, element('h3', {}, title), element('label', {}, log, ' log scale')),
      element('div', { className: 'chart' }, canvas),
    );
    return { title, canvas, log, box };
  }

  draw_soon() {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.draw());
  }

  draw() {
    if (this.runs.length === 0) {
      $('runs-body').replaceChildren(...(this.problems ? [this.problems] : []));
      return;
    }
    this.draw_legend();
    for (const metric of this.metrics) this.draw_chart(metric);
    this.draw_table();
  }

  draw_legend() {
    // A checkbox that was just used keeps the focus.
    const focused = [...this.legend.querySelectorAll('input')].indexOf(document.activeElement);
    const items = this.runs.map((run, i) => {
      const box = element('input', { type: 'checkbox', checked: !this.hidden.has(run.name) });
      box.addEventListener('change', () => {
        if (box.checked) this.hidden.delete(run.name);
        else this.hidden.add(run.name);
        this.draw();
      });
      const style = series_style(i, theme.dark);
      const key = element('span', { className: `key ${style.dash_name}` });
      key.style.color = style.colour;
      return element('li', {}, element('label', {}, box, key, run.name));
    });
    this.legend.replaceChildren(...items);
    if (focused >= 0) items[focused]?.querySelector('input').focus();
  }

  curves(metric) {
    return this.runs
      .map((run, i) => ({ run, style: series_style(i, theme.dark), points: points_of(run, metric, this.over_amounts) }))
      .filter(({ run, points }) => points.length > 0 && !this.hidden.has(run.name));
  }

  draw_chart(metric) {
    const { canvas, log, title } = this.charts.get(metric);
    const curves = this.curves(metric);
    const values = curves.flatMap(({ points }) => points.map((point) => point.y));
    const least = values.reduce((a, b) => Math.min(a, b), Infinity);
    const most = values.reduce((a, b) => Math.max(a, b), -Infinity);
    const usual = metric.includes('loss') && most / least > kLogSpan;
    log.disabled = !(least > 0);
    log.checked = least > 0 && (this.log.get(metric) ?? usual);
    const units = new Set(curves.map(({ run }) => (this.over_amounts ? run.amount : run.counter)));
    canvas.setAttribute('aria-label', this.describe(title, curves));
    put_chart(canvas, {
      type: 'line',
      data: { datasets: curves.flatMap((curve) => this.lines_of(curve)) },
      options: {
        parsing: false,
        interaction: { mode: 'nearest', axis: 'x', intersect: false },
        scales: {
          x: axis([...units].join(' or '), { grid: { display: false } }),
          y: axis('', { type: log.checked ? 'logarithmic' : 'linear' }),
        },
        plugins: {
          decimation: { enabled: true, algorithm: 'min-max' },
          tooltip: { filter: ({ dataset }) => !dataset.raw, callbacks: { title: tooltip_title, label: tooltip_value } },
        },
      },
    });
  }

  lines_of({ run, style, points }) {
    const alone = points.length === 1 ? 3 : 0; // a single point makes no line
    const thick = {
      label: run.name,
      data: smoothed(points, this.smoothing),
      borderColor: style.colour,
      borderDash: style.dash,
      borderWidth: 2.25,
      pointBackgroundColor: style.colour,
      pointRadius: alone,
    };
    if (past_share(points, this.smoothing) === 0) return [thick];
    return [{ raw: true, data: points, borderColor: `${style.colour}50`, borderWidth: 1 }, thick];
  }

  describe(title, curves) {
    const span = (points) => `from ${significant(points[0].y)} to ${significant(points[points.length - 1].y)}`;
    const ends = curves.map(({ run, points }) => `${run.name} ${span(points)}`);
    return `Chart of ${title}: ${ends.join('; ') || 'no values yet'}.`;
  }

  draw_table() {
    const latest = (run, name) => run.lines.map((line) => line[name]).findLast(is_number);
    const cell = (value) => (value === undefined ? kDash : significant(value));
    const length = (run) => (run.counter ? `${run.counter} ${plain(latest(run, run.counter))}` : 'nothing yet');
    const rows = this.runs.map((run) =>
      table_row(run.name, [length(run), ...this.metrics.map((metric) => cell(latest(run, metric)))]),
    );
    const metrics = this.metrics.map((metric) => ({ name: this.charts.get(metric).title }));
    const head = table_head([{ name: 'run', text: true }, { name: 'at' }, ...metrics]);
    const caption = table_caption('Latest values, not smoothed');
    this.table.replaceChildren(element('table', {}, caption, head, element('tbody', {}, ...rows)));
  }
}

const tooltip_title = (items) => (items.length > 0 ? `at ${plain(items[0].parsed.x)}` : '');

const tooltip_value = ({ dataset, parsed }) => `${dataset.label}: ${significant(parsed.y)}`;
