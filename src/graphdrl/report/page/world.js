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

  // Calls `see` for every obstacle beside a free node: in the cells around it, or where an edge leads from it.
  for_each_obstacle(see) {
    const look = (from, to) => {
      if (this.blocked[to] && !this.blocked[from]) see(from, to);
    };
    for (let i = 0; i < this.edges.length; i += 2) {
      look(this.edges[i], this.edges[i + 1]);
      if (!this.directed) look(this.edges[i + 1], this.edges[i]);
    }
    if (!this.is_grid || this.valid_count === this.node_count) return;
    for (let node = 0; node < this.node_count; ++node) {
      const [row, col] = [Math.floor(node / this.cols), node % this.cols];
      for (let r = Math.max(row - 1, 0); r <= Math.min(row + 1, this.rows - 1); ++r) {
        for (let c = Math.max(col - 1, 0); c <= Math.min(col + 1, this.cols - 1); ++c) look(node, r * this.cols + c);
      }
    }
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
    this.discovery = plan.seen_nodes ? new Discovery(world, this) : null;
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

// Things by the step at which they are shown, for those shown at all.
class Schedule {
  // steps: of each thing; −1: never.
  constructor(steps, last) {
    this.begins = new Uint32Array(last + 2); // where the things of each step begin
    for (const step of steps) if (step >= 0) ++this.begins[step + 1];
    for (let step = 0; step <= last; ++step) this.begins[step + 1] += this.begins[step];
    this.things = new Uint32Array(this.begins[last + 1]);
    const next = this.begins.slice();
    steps.forEach((step, thing) => {
      if (step >= 0) this.things[next[step]++] = thing;
    });
  }

  // Those of the steps from..to.
  shown(from, to) {
    return this.things.subarray(this.begins[from], this.begins[to + 1]);
  }
}

// How a world that was not known beforehand became known on a walk. An obstacle is seen with the first node beside it.
// An edge is known once both ends are seen or, where visits show edges, once a node that it leaves is visited.
class Discovery {
  constructor(world, trail) {
    const { seen_nodes, seen_after_step, reveal } = trail.plan;
    this.policy = trail.policy;
    this.last = trail.last;
    this.read(world, seen_nodes, seen_after_step);
    world.for_each_obstacle((node, obstacle) => {
      const [step, before] = [this.first_seen[node], this.first_seen[obstacle]];
      if (step >= 0 && (before < 0 || step < before)) this.first_seen[obstacle] = step;
    });
    this.nodes = new Schedule(this.first_seen, this.last);
    this.follow_edges(world, reveal === 'edges' ? trail.first_visit : null);
  }

  read(world, nodes, counts) {
    check(
      Array.isArray(nodes) && Array.isArray(counts) && counts.length === this.last + 1,
      `the plan of ${this.policy} does not have one count of nodes seen per node of its walk`,
    );
    this.seen = Uint32Array.from(counts); // by each step
    const rising = this.seen.every((count, step) => step === 0 || count >= this.seen[step - 1]);
    const fitting = rising && this.seen[this.last] === nodes.length;
    check(fitting, `the nodes that ${this.policy} sees do not fit their counts`);
    this.first_seen = new Int32Array(world.node_count).fill(-1);
    let step = 0;
    nodes.forEach((node, i) => {
      check(world.has(node), `${this.policy} sees node ${node}, but the world has ${world.node_count}`);
      while (this.seen[step] <= i) ++step;
      this.first_seen[node] = step;
    });
  }

  // visited_at: of each node, where visits show edges; else null.
  follow_edges({ edges, directed }, visited_at) {
    const at = visited_at ?? this.first_seen;
    const steps = new Int32Array(edges.length / 2).map((_, edge) => {
      const [a, b] = [at[edges[2 * edge]], at[edges[2 * edge + 1]]];
      if (visited_at && directed) return a;
      const [first, last] = a < b ? [a, b] : [b, a];
      if (visited_at) return first < 0 ? last : first;
      return first < 0 ? -1 : last;
    });
    this.edge_schedule = new Schedule(steps, this.last);
    this.edges = new Uint32Array(2 * this.edge_schedule.things.length);
    this.edge_schedule.things.forEach((edge, i) => {
      this.edges[2 * i] = edges[2 * edge];
      this.edges[2 * i + 1] = edges[2 * edge + 1];
    });
  }

  // The ends of those that become known at the steps from..to, as in World.edges.
  edges_shown(from, to) {
    const { begins } = this.edge_schedule;
    return this.edges.subarray(2 * begins[from], 2 * begins[to + 1]);
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
