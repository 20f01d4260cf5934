// Worlds and walks, as the page uses them: checked, in typed arrays.

function decode_base64(text) {
  try {
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  } catch {
    throw new DataError('the set of blocked nodes is not base64');
  }
}

// A world with a place for every node, y downward as on a screen.
class World {
  constructor(data) {
    check(data && typeof data === 'object', 'the world is missing');
    check(Number.isInteger(data.nodes) && data.nodes > 0, 'the world has no nodes');
    check(data.kind === 'grid' || data.kind === 'graph', `the world's kind is "${data.kind}", not "grid" or "graph"`);
    this.name = String(data.name ?? '');
    this.node_count = data.nodes;
    this.valid_count = data.valid;
    this.is_grid = data.kind === 'grid';
    this.directed = Boolean(data.directed);
    this.unit = data.unit ? ` ${data.unit}` : '';
    this.labels = this.list_of(data.labels, 'labels');
    this.prizes = this.list_of(data.prizes, 'prizes');
    this.read_blocked(data.blocked);
    if (this.is_grid) this.read_grid(data);
    else this.read_graph(data);
  }

  // A list with one entry per node, or null.
  list_of(list, what) {
    if (list === null || list === undefined) return null;
    check(Array.isArray(list) && list.length === this.node_count, `the ${what} are not one per node`);
    return list;
  }

  read_blocked(text) {
    const bits = text ? decode_base64(text) : new Uint8Array(0);
    check(!text || bits.length * 8 >= this.node_count, 'the set of blocked nodes is too short');
    this.blocked = new Uint8Array(this.node_count);
    for (let node = 0; node < this.node_count && text; ++node) this.blocked[node] = (bits[node >> 3] >> (node & 7)) & 1;
    let free = 0;
    for (const blocked of this.blocked) free += 1 - blocked;
    check(free === this.valid_count, `${this.valid_count} nodes should be valid, but ${free} are not blocked`);
    this.total_prize = 0;
    if (this.prizes) this.prizes.forEach((prize, node) => (this.total_prize += this.blocked[node] ? 0 : prize));
  }

  read_grid({ rows, cols }) {
    check(rows * cols === this.node_count, `a grid of ${rows} by ${cols} cells does not have ${this.node_count} nodes`);
    this.rows = rows;
    this.cols = cols;
    this.x = new Float32Array(this.node_count);
    this.y = new Float32Array(this.node_count);
    for (let node = 0; node < this.node_count; ++node) {
      this.x[node] = (node % cols) + 0.5;
      this.y[node] = Math.floor(node / cols) + 0.5;
    }
    this.box = { left: 0, top: 0, right: cols, bottom: rows };
    this.spacing = 1;
    this.edges = new Uint32Array(0);
  }

  read_graph({ edges, x, y, laid_out }) {
    check(Array.isArray(edges) && edges.length % 2 === 0, 'the edges are not a list of pairs');
    for (const node of edges) check(this.has(node), `an edge names node ${node}, which is not there`);
    this.edges = Uint32Array.from(edges);
    this.laid_out = Boolean(laid_out);
    this.x = Float32Array.from(this.list_of(x ?? [], 'x coordinates'));
    this.y = Float32Array.from(this.list_of(y ?? [], 'y coordinates'), (value) => -value);
    this.measure();
  }

  // The box around all nodes, with a margin, and the typical distance of neighbours.
  measure() {
    const box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
    for (let node = 0; node < this.node_count; ++node) {
      check(Number.isFinite(this.x[node]) && Number.isFinite(this.y[node]), `node ${node} has no place`);
      box.left = Math.min(box.left, this.x[node]);
      box.right = Math.max(box.right, this.x[node]);
      box.top = Math.min(box.top, this.y[node]);
      box.bottom = Math.max(box.bottom, this.y[node]);
    }
    const width = box.right - box.left;
    const height = box.bottom - box.top;
    const longest = Math.max(width, height) || 1;
    this.spacing = Math.max(Math.sqrt((width * height) / this.node_count), longest / this.node_count);
    const margin_x = Math.max(0.04 * longest, (0.25 * longest - width) / 2);
    const margin_y = Math.max(0.04 * longest, (0.25 * longest - height) / 2);
    this.box = {
      left: box.left - margin_x,
      right: box.right + margin_x,
      top: box.top - margin_y,
      bottom: box.bottom + margin_y,
    };
  }

  has(node) {
    return Number.isInteger(node) && node >= 0 && node < this.node_count;
  }

  name_of(node) {
    if (this.labels) return `${this.labels[node]} (node ${node})`;
    if (this.is_grid) return `node ${node} (row ${Math.floor(node / this.cols)}, column ${node % this.cols})`;
    return `node ${node}`;
  }

  // The world described in a few words.
  describe() {
    const cells = `${plain(this.rows)} by ${plain(this.cols)} cells`;
    const size = this.is_grid ? cells : plural(this.node_count, 'node');
    return `${this.name}, ${size}, ${plain(this.valid_count)} valid`;
  }
}

// A plan's walk, with what has been visited at each step. Memory is linear in the walk and in the nodes.
class Trail {
  constructor(world, plan, budget) {
    check(plan && typeof plan === 'object', 'a plan is missing');
    this.plan = plan;
    this.budget = is_number(plan.budget) ? plan.budget : budget;
    this.policy = String(plan.policy);
    check(Array.isArray(plan.walk) && plan.walk.length > 0, `the plan of ${this.policy} has no walk`);
    for (const node of plan.walk) {
      check(world.has(node), `the walk of ${this.policy} names node ${node}, but the world has ${world.node_count}`);
      check(!world.blocked[node], `the walk of ${this.policy} goes over node ${node}, which is blocked`);
    }
    this.nodes = Uint32Array.from(plan.walk);
    this.last = this.nodes.length - 1;
    this.read_costs(plan.costs);
    this.follow(world);
    check(
      plan.visited === this.visited[this.last],
      `the plan of ${this.policy} says it visits ${plan.visited} nodes, but its walk visits ${this.visited[this.last]}`,
    );
  }

  // Without costs, every step costs 1.
  read_costs(costs) {
    if (costs === null || costs === undefined) {
      this.costs = Float64Array.from(this.nodes, (_, step) => step);
      return;
    }
    check(
      Array.isArray(costs) && costs.length === this.nodes.length,
      `the plan of ${this.policy} does not have one cost per node of its walk`,
    );
    for (let step = 0; step <= this.last; ++step) {
      check(
        is_number(costs[step]) && (step === 0 || costs[step] >= costs[step - 1]),
        `the costs of ${this.policy} do not rise at step ${step}`,
      );
    }
    this.costs = Float64Array.from(costs);
  }

  follow(world) {
    this.first_visit = new Int32Array(world.node_count).fill(-1);
    this.visited = new Uint32Array(this.nodes.length);
    this.prize = world.prizes ? new Float64Array(this.nodes.length) : null;
    let visited = 0;
    let prize = 0;
    for (let step = 0; step <= this.last; ++step) {
      const node = this.nodes[step];
      if (this.first_visit[node] < 0) {
        this.first_visit[node] = step;
        ++visited;
        if (this.prize) prize += world.prizes[node];
      }
      this.visited[step] = visited;
      if (this.prize) this.prize[step] = prize;
    }
    this.valid_count = world.valid_count;
    this.total_prize = world.total_prize;
  }

  coverage(step) {
    return (100 * this.visited[step]) / this.valid_count;
  }

  // In percent: of all prizes if the world has any, else of all nodes. Upper bounds are in this unit.
  worth(step) {
    if (!this.prize) return this.coverage(step);
    return this.total_prize > 0 ? (100 * this.prize[step]) / this.total_prize : 100;
  }

  band(step) {
    return this.last === 0 ? 0 : Math.floor(((kBands - 1) * step) / this.last);
  }

  // The scores at a step as [{node, score}], best first; null without scores.
  scores(step) {
    const flat = this.plan.scores?.[step];
    if (!Array.isArray(flat) || flat.length < 2) return null;
    const scores = [];
    for (let i = 0; i + 1 < flat.length; i += 2) {
      if (flat[i] in this.first_visit) scores.push({ node: flat[i], score: flat[i + 1] });
    }
    const sign = this.plan.lower_is_better ? 1 : -1;
    return scores.sort((a, b) => sign * (a.score - b.score) || a.node - b.node);
  }
}

// One clock for the plans on show: tick by tick the smallest cost that any of them reaches next. At a tick all plans
// have spent at most the same, so that they compare fairly. With one plan, a tick is a step.
class Clock {
  constructor(trails) {
    const at = trails.map(() => 0);
    const costs = [Math.max(...trails.map((trail) => trail.costs[0]))];
    const steps = trails.map(() => [0]);
    for (;;) {
      let next = Infinity;
      trails.forEach((trail, i) => {
        if (at[i] < trail.last) next = Math.min(next, trail.costs[at[i] + 1]);
      });
      if (next === Infinity) break;
      // Sums of costs are rounded differently along different walks.
      const reached = next + 1e-9 * Math.max(1, Math.abs(next));
      trails.forEach((trail, i) => {
        if (at[i] < trail.last && trail.costs[at[i] + 1] <= reached) ++at[i];
        steps[i].push(at[i]);
      });
      costs.push(next);
    }
    this.costs = Float64Array.from(costs);
    this.steps = steps.map((list) => Uint32Array.from(list));
    this.last = costs.length - 1;
  }
}
