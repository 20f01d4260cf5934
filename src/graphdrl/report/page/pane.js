// One plan on show: its map, its numbers, its possible moves.

const kMostInText = 2000; // nodes of a walk written out

class Pane {
  constructor(world, plan_trail, viewport, place, alone) {
    this.world = world;
    this.trail = plan_trail;
    this.root = $('pane-template').content.firstElementChild.cloneNode(true);
    this.root.classList.toggle('pane-alone', alone);
    this.find('.swatch').style.color = `var(--plan-${place})`;
    this.find('.pane-name').textContent = plan_trail.policy;
    this.map = new MapView(this.find('.map'), world, plan_trail, viewport, (node) => this.point(node));
    this.set_up_numbers();
    this.set_up_texts();
    this.listen();
    this.point(-1);
    this.recolour();
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  close() {
    this.map.close();
  }

  listen() {
    this.find('.zoom-in').addEventListener('click', () => this.map.zoom(1.6));
    this.find('.zoom-out').addEventListener('click', () => this.map.zoom(1 / 1.6));
    this.find('.zoom-fit').addEventListener('click', () => this.map.viewport.fit());
    const details = this.find('.walk-text');
    details.addEventListener('toggle', () => {
      if (details.open) details.querySelector('p').textContent = this.walk_text();
    });
  }

  set_up_numbers() {
    const names = { step: 'Step', visited: 'Visited', coverage: 'Coverage', cost: 'Budget spent', bound: 'At most' };
    if (this.trail.prize) names.prize = 'Prize';
    if (this.trail.discovery) names.seen = 'Seen';
    this.numbers = {};
    for (const [name, title] of Object.entries(names)) {
      const value = element('span', { className: `number-${name}` });
      const of = element('small');
      this.numbers[name] = value;
      this.numbers[`${name}_of`] = of;
      this.find('.numbers').append(element('div', {}, element('dt', {}, title), element('dd', {}, value, ' ', of)));
    }
    const { trail, world } = this;
    const { upper_bound, optimal } = trail.plan;
    const { budget } = trail;
    this.numbers.step_of.textContent = `of ${plain(trail.last)}`;
    this.numbers.visited_of.textContent = `of ${plain(world.valid_count)}`;
    this.numbers.cost_of.textContent = is_number(budget) ? `of ${plain(budget)}${world.unit}` : world.unit;
    this.numbers.bound.textContent = is_number(upper_bound) ? `${fixed(upper_bound)} %` : kDash;
    this.numbers.bound_of.textContent = optimal ? 'optimal' : this.trail.prize ? 'of prizes' : '';
    if (trail.discovery) this.numbers.seen_of.textContent = `of ${plain(world.valid_count)}`;
    if (trail.prize) this.numbers.prize_of.textContent = `of ${plain(world.total_prize)}`;
  }

  set_up_texts() {
    const { trail, world } = this;
    this.find('.map').setAttribute('aria-label', `Map of ${world.describe()}. ${this.summary()}`);
    this.find('.score-key').hidden = !trail.plan.scores;
    this.find('.scores').hidden = !trail.plan.scores;
    if (world.laid_out) this.note('This graph has no coordinates. It is drawn so that near nodes lie near each other.');
  }

  // Whether the fog is shown, where the walk has any.
  set_fog(on) {
    const { map, trail, world } = this;
    map.set_fog(on);
    const marked_of = map.fogged ? trail.discovery.seen[trail.last] : world.valid_count;
    this.find('.fog-key').hidden = !map.fogged;
    this.find('.missed-key').hidden = trail.visited[trail.last] === marked_of;
  }

  note(text) {
    this.find('.note').textContent = text;
    this.find('.note').hidden = false;
  }

  // The whole plan in a few sentences.
  summary() {
    const { trail, world } = this;
    const end = trail.last;
    const missed = world.valid_count - trail.visited[end];
    const visited = `${plain(trail.visited[end])} nodes, ${fixed(trail.coverage(end))} %`;
    return [
      `The walk of ${trail.policy} has ${plural(end, 'step')} and visits ${visited},`,
      `for ${plain(trail.costs[end])}${world.unit}.`,
      `It starts at ${world.name_of(trail.nodes[0])} and ends at ${world.name_of(trail.nodes[end])}.`,
      missed === 0 ? 'It misses none.' : `It misses ${plain(missed)}.`,
      ...(trail.discovery ? [`It sees ${plain(trail.discovery.seen[end])} of ${plain(world.valid_count)} nodes.`] : []),
    ].join(' ');
  }

  walk_text() {
    const { trail, world } = this;
    const name = (node) => (world.labels ? world.labels[node] : node);
    const shown = Array.from(trail.nodes.subarray(0, kMostInText), name);
    const rest = trail.nodes.length - shown.length;
    return `${this.summary()} Nodes in order: ${shown.join(' ')}${rest > 0 ? ` and ${plain(rest)} more` : ''}`;
  }

  point(node) {
    const { trail, world } = this;
    const line = this.find('.pointed');
    if (node < 0) {
      line.textContent = `Point at a ${world.is_grid ? 'cell' : 'node'} to see what it is.`;
      return;
    }
    const first = trail.first_visit[node];
    const visit = first < 0 ? 'never visited' : `first visited at step ${plain(first)}`;
    const seen_at = trail.discovery?.first_seen[node];
    const sight = seen_at < 0 ? 'never seen' : `first seen at step ${plain(seen_at)}`;
    const prize = world.prizes ? `, prize ${plain(world.prizes[node])}` : '';
    const what = world.blocked[node] ? 'blocked' : visit;
    line.textContent = `${world.name_of(node)}${prize}: ${what}${trail.discovery ? `, ${sight}` : ''}`;
  }

  show(step) {
    const { trail, world, numbers } = this;
    this.step = step;
    this.map.show(step);
    numbers.step.textContent = plain(step);
    numbers.visited.textContent = plain(trail.visited[step]);
    numbers.coverage.textContent = `${fixed(trail.coverage(step))} %`;
    numbers.cost.textContent = plain(trail.costs[step]);
    if (trail.discovery) numbers.seen.textContent = plain(trail.discovery.seen[step]);
    if (trail.prize) numbers.prize.textContent = plain(trail.prize[step]);
    if (trail.plan.scores) this.show_scores(trail.scores(step) ?? [], world);
  }

  show_scores(scores, world) {
    const next = this.trail.nodes[this.step + 1];
    const title = (node) => `${world.name_of(node)}${node === next ? ', taken' : ''}`;
    const name = this.trail.plan.scores_name ?? 'score';
    this.find('.scores h4').textContent = `Possible moves, by ${name}`;
    const items = scores.slice(0, kScoresShown).map(({ node, score }, place) =>
      element(
        'li',
        { className: node === next ? 'taken' : '' },
        element('span', {}, String(place + 1)),
        element('span', {}, title(node)),
        element('span', {}, is_number(score) ? significant(score) : kDash),
      ),
    );
    const rest = scores.length - items.length;
    if (rest > 0) items.push(element('li', { className: 'remark' }, `and ${plain(rest)} more`));
    if (items.length === 0) items.push(element('li', { className: 'remark' }, 'none here'));
    this.find('.scores ol').replaceChildren(...items);
  }

  // One sentence for readers who hear the page.
  spoken() {
    const { trail, step, world } = this;
    const budget = is_number(trail.budget) ? ` of ${plain(trail.budget)}` : '';
    const where = `step ${plain(step)} of ${plain(trail.last)}, at ${world.name_of(trail.nodes[step])}`;
    const spent = `${plain(trail.costs[step])}${budget} spent`;
    const seen = trail.discovery ? `, ${plural(trail.discovery.seen[step], 'node')} seen` : '';
    return `${trail.policy}: ${where}, ${fixed(trail.coverage(step))} % visited${seen}, ${spent}.`;
  }

  recolour() {
    const bar = this.find('.order-bar');
    const context = bar.getContext('2d');
    walk_scale(theme.dark).forEach((colour, band) => {
      context.fillStyle = colour;
      context.fillRect((band * bar.width) / kBands, 0, 1, bar.height);
    });
    this.map.recolour();
  }
}
