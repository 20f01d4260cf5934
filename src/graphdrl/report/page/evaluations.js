// Comparisons of policies on maps: the paper's Table 2, and the ladder over all maps.

const kAll = 'all';

function read_evaluation(evaluation) {
  check(Array.isArray(evaluation.rows), 'it has no rows');
  check(Array.isArray(evaluation.overall), 'it has no overall results');
  const rows = evaluation.rows;
  return {
    rows,
    overall: evaluation.overall,
    policies: [...new Set(rows.map((row) => String(row.policy)))],
    maps: [...new Set(rows.map((row) => String(row.map)))],
    has_paper: rows.some((row) => row.paper),
  };
}

// The 95 % interval of the mean over maps, from the maps' own intervals: errors of different maps are independent. Null
// if a map has no interval.
function overall_interval(rows, mean) {
  if (rows.length === 0 || !is_number(mean)) return null;
  if (!rows.every((row) => Array.isArray(row.ci95))) return null;
  const half = Math.sqrt(rows.reduce((sum, { ci95 }) => sum + ((ci95[1] - ci95[0]) / 2) ** 2, 0)) / rows.length;
  return [mean - half, mean + half];
}

// What all rows share, for the caption: the budget and the episodes.
function shared_by(rows, name) {
  const values = new Set(rows.map((row) => row[name]));
  return values.size === 1 ? [...values][0] : null;
}

function interval_text(interval) {
  return Array.isArray(interval) ? `${fixed(interval[0])} – ${fixed(interval[1])}` : kDash;
}

// One evaluation: its tables and charts, redrawn when the data, the theme or the choice of policy change.
class EvaluationView {
  constructor(name) {
    this.name = name;
    this.policy = kAll;
    this.root = element('article', { className: 'evaluation' });
  }

  update(evaluation) {
    this.data = read_evaluation(evaluation);
    if (!this.data.policies.includes(this.policy)) this.policy = kAll;
    this.build();
  }

  build() {
    const { policies } = this.data;
    const select = element('select', { className: 'policy-choice' });
    select.append(new Option('all', kAll), ...policies.map((policy) => new Option(policy, `policy:${policy}`)));
    select.value = this.policy === kAll ? kAll : `policy:${this.policy}`;
    select.addEventListener('change', () => {
      this.policy = select.value === kAll ? kAll : select.value.slice('policy:'.length);
      this.draw_maps();
    });
    this.table = table_box('Results per map', 'tall');
    this.map_chart = this.chart_box('Coverage per map, %');
    this.ladder_chart = this.chart_box('Mean over maps, %');
    this.root.replaceChildren(
      element('h3', {}, this.name),
      element('h4', {}, 'The ladder: all maps together'),
      element('div', { className: 'ladder' }, this.ladder_table(), this.ladder_chart.box),
      element('h4', {}, 'Map by map'),
      element('div', { className: 'fields' }, element('label', {}, 'Policy ', select)),
      this.table,
      this.map_chart.box,
    );
    this.draw();
  }

  chart_box(title) {
    const canvas = element('canvas', { role: 'img' });
    const chart = element('div', { className: 'chart' }, canvas);
    const legend = element('ul', { className: 'legend' });
    const caption = element('figcaption', {}, element('span', {}, title), legend);
    const box = element('figure', { className: 'chart-box' }, caption, chart);
    return { box, canvas, chart, legend };
  }

  draw() {
    this.draw_ladder();
    this.draw_maps();
  }

  style_of(policy) {
    return series_style(this.data.policies.indexOf(policy), theme.dark);
  }

  rows_of(policy) {
    return this.data.rows.filter((row) => String(row.policy) === policy);
  }

  intervals() {
    return this.data.overall.map((entry) => overall_interval(this.rows_of(String(entry.policy)), entry.mean));
  }

  ladder_table() {
    const intervals = this.intervals();
    const numbers = ['maps', 'mean', '95 % interval', 'of the optimum'].map((name) => ({ name }));
    const rows = this.data.overall.map((entry, i) => {
      const share = is_number(entry.ratio_to_optimum) ? `${fixed(100 * entry.ratio_to_optimum)} %` : kDash;
      const values = [plain(entry.maps), fixed(entry.mean), interval_text(intervals[i]), share];
      return table_row(String(entry.policy), values);
    });
    const caption = 'Coverage in %, mean of the maps. The interval is made from those of the maps.';
    const head = table_head([{ name: 'policy', text: true }, ...numbers]);
    const box = table_box('The ladder');
    const body = element('tbody', {}, ...rows);
    box.append(element('table', { className: 'ladder-table' }, table_caption(caption), head, body));
    return box;
  }

  // Bars from nought to the mean; on them every map's mean as a dot, and the interval.
  draw_ladder() {
    const { overall } = this.data;
    const intervals = this.intervals();
    const dots = (rows) => rows.map((row) => ({ shape: 'faint dot', x: row.mean, size: 2.5 }));
    const lines = (interval) => (interval ?? []).map((x) => ({ shape: 'line', x: clamp(x, 0, 100) }));
    const measured = (policy) => this.rows_of(policy).filter((row) => is_number(row.mean));
    const marks = overall.map((entry, i) => [...dots(measured(String(entry.policy))), ...lines(intervals[i])]);
    const colours = overall.map((entry) => this.style_of(String(entry.policy)).colour);
    const { canvas, chart, legend } = this.ladder_chart;
    chart.style.height = `${60 + 26 * overall.length}px`;
    const means = overall.map((entry) => `${entry.policy} ${fixed(entry.mean)} %`);
    canvas.setAttribute('aria-label', `Chart of the ladder: ${means.join(', ')}.`);
    legend.replaceChildren(element('li', {}, '● one map'), element('li', {}, '❘ 95 % interval of the mean'));
    put_chart(canvas, {
      type: 'bar',
      data: {
        labels: overall.map((entry) => short_name(entry.policy)),
        datasets: [
          {
            data: overall.map((entry) => entry.mean),
            backgroundColor: colours.map((colour) => `${colour}66`),
            borderColor: colours,
            borderWidth: 1,
            marks,
            mark_colour: theme.get('text'),
          },
        ],
      },
      options: bar_options((_, bar) => `${fixed(overall[bar].mean)} %, ${interval_text(intervals[bar])}`),
    });
  }

  draw_maps() {
    this.draw_map_table();
    const shown = this.policy === kAll ? this.data.policies : [this.policy];
    const by_map = (policy) => new Map(this.rows_of(policy).map((row) => [String(row.map), row]));
    const rows = shown.map((policy) => this.data.maps.map((map) => by_map(policy).get(map) ?? null));
    const { canvas, chart, legend } = this.map_chart;
    chart.style.height = `${60 + this.data.maps.length * (12 + 9 * Math.max(shown.length, 2))}px`;
    canvas.setAttribute('aria-label', 'Chart of coverage per map and policy; the table before it has the numbers.');
    legend.replaceChildren(...this.map_legend(shown));
    put_chart(canvas, {
      type: 'bar',
      data: {
        labels: this.data.maps.map(short_name),
        datasets: shown.map((policy, i) => this.map_bars(policy, rows[i])),
      },
      options: bar_options((set, bar) => {
        const row = rows[set][bar];
        return row ? `${shown[set]}: ${fixed(row.mean)} %, ${interval_text(row.ci95)}` : '';
      }),
    });
  }

  // A bar is the interval, the dot in it the mean; with one policy, the optimum and the paper's mean too.
  map_bars(policy, rows) {
    const { colour } = this.style_of(policy);
    const alone = this.policy !== kAll;
    const marks = rows.map((row) => [
      ...(alone && is_number(row?.optimum) ? [{ shape: 'line', x: row.optimum }] : []),
      ...(alone && row?.paper ? [{ shape: 'cross', x: row.paper.mean }] : []),
      ...(is_number(row?.mean) ? [{ shape: 'dot', x: row.mean }] : []),
    ]);
    return { label: policy, data: rows.map(bar_of), backgroundColor: `${colour}66`, marks, mark_colour: colour };
  }

  map_legend(shown) {
    const items = shown.map((policy) => key_item(this.style_of(policy).colour, '', policy));
    items.push(element('li', {}, '● mean'), element('li', {}, '▬ 95 % interval'));
    if (this.policy === kAll) return items;
    items.push(element('li', {}, '❘ optimum'));
    if (this.data.has_paper) items.push(element('li', {}, '✕ the paper’s mean'));
    return items;
  }

  draw_map_table() {
    const { has_paper } = this.data;
    const rows = this.data.rows.filter((row) => this.policy === kAll || String(row.policy) === this.policy);
    const paper_columns = has_paper ? ['paper: mean', 'std', 'best'].map((name) => ({ name })) : [];
    const columns = [{ name: 'map', text: true }, { name: 'policy', text: true }];
    for (const name of ['nodes', 'mean', 'std', 'best', '95 % interval', 'optimum']) columns.push({ name });
    this.table.replaceChildren(
      element(
        'table',
        { className: 'map-table' },
        table_caption(this.caption(rows)),
        table_head([...columns, ...paper_columns]),
        element('tbody', {}, ...rows.map((row) => map_row(row, has_paper))),
      ),
    );
  }

  caption(rows) {
    const budget = shared_by(rows, 'budget');
    const episodes = shared_by(rows, 'episodes');
    const parts = ['Coverage in %'];
    if (is_number(budget)) parts.push(`budget ${plain(budget)}`);
    if (is_number(episodes)) parts.push(`${plural(episodes, 'episode')} per map`);
    return parts.join(', ');
  }
}

// The interval, cut at 0 and 100; a point if there is only a mean.
function bar_of(row) {
  if (Array.isArray(row?.ci95)) return row.ci95.map((x) => clamp(x, 0, 100));
  return is_number(row?.mean) ? [row.mean, row.mean] : null;
}

function map_row(row, has_paper) {
  const paper = has_paper ? [row.paper?.mean, row.paper?.std, row.paper?.best].map((value) => fixed(value)) : [];
  const results = [fixed(row.mean), fixed(row.std), fixed(row.best), interval_text(row.ci95), fixed(row.optimum)];
  const made = table_row(String(row.map), [plain(row.valid_nodes), ...results, ...paper]);
  made.firstChild.after(element('td', { className: 'text' }, String(row.policy)));
  return made;
}

const short_name = (name) => (String(name).length > 18 ? `${String(name).slice(0, 17)}…` : String(name));

// Of a horizontal bar chart in percent; text_of(dataset, bar) is a bar's tooltip.
function bar_options(text_of) {
  return {
    indexAxis: 'y',
    scales: {
      x: axis('', { min: 0, max: 100 }),
      y: { grid: { display: false }, ticks: { autoSkip: false, crossAlign: 'far' } },
    },
    plugins: {
      tooltip: { callbacks: { label: ({ datasetIndex, dataIndex }) => text_of(datasetIndex, dataIndex) } },
    },
  };
}

class Evaluations {
  constructor() {
    this.views = new Map(); // name: view
    theme.on_change(() => {
      for (const view of this.views.values()) view.draw();
    });
  }

  update(evaluations) {
    const text = JSON.stringify(evaluations);
    if (text === this.text) return;
    this.text = text;
    const body = element('div');
    const views = new Map();
    evaluations.forEach((evaluation, i) => {
      const name = String(evaluation?.name ?? `Evaluation ${i + 1}`);
      guarded(body, name, () => {
        const view = this.views.get(name) ?? new EvaluationView(name);
        view.update(evaluation);
        views.set(name, view);
        body.append(view.root);
      });
    });
    this.views = views;
    $('evaluations-body').replaceChildren(body);
  }
}
