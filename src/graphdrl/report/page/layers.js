// The pictures a map is made of: the world, drawn once per view; the fog over it and the walk on it, drawn step after
// step.
// A view {scale, dx, dy} takes places of the world to pixels of the device.

const kLineCell = 5; // pixels of a cell from which a walk is a line over tinted cells; below, it fills the cells
const kLanesFrom = 14; // pixels of a cell from which ways there and back are drawn side by side
const kTint = 0.3;
const kEdgesPerStroke = 2000; // one path with all edges would be slower by far
const kMostArrows = 3000;
const kMostLabels = 400;
const kCheckpointEvery = 4000; // steps, at least
const kMostCheckpoints = 6;

// Sizes in pixels of the device; `ratio` is their number per CSS pixel.
function sizes_of(world, view, ratio) {
  const spacing = (world.spacing * view.scale) / ratio;
  const cells = world.is_grid;
  return {
    ratio,
    spacing, // CSS pixels from neighbour to neighbour
    node: ratio * clamp(spacing * 0.16, 0.6, 8),
    line: ratio * (cells ? clamp(spacing * 0.13, 1, 5) : clamp(spacing * 0.08, 1, 3.5)),
    edge: ratio * clamp(spacing * 0.03, 0.4, 1.25),
    lane: spacing < kLanesFrom ? 0 : ratio * (cells ? clamp(spacing * 0.1, 1, 7) : 2),
    mark: ratio * (cells ? clamp(spacing * 0.28, 4, 10) : clamp(spacing * 0.25, 4.5, 9)),
    fills: cells && spacing < kLineCell,
  };
}

function clear_canvas(canvas, width, height) {
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  } else {
    canvas.getContext('2d').clearRect(0, 0, width, height);
  }
}

class Projection {
  constructor(world, view, width, height) {
    Object.assign(this, { world, view, width, height });
  }
  x(node) {
    return this.world.x[node] * this.view.scale + this.view.dx;
  }
  y(node) {
    return this.world.y[node] * this.view.scale + this.view.dy;
  }
  sees(node, margin) {
    const x = this.x(node);
    const y = this.y(node);
    return x >= -margin && y >= -margin && x <= this.width + margin && y <= this.height + margin;
  }
  // Whether a line between two nodes can cross the picture.
  sees_line(a, b) {
    const [ax, ay, bx, by] = [this.x(a), this.y(a), this.x(b), this.y(b)];
    const after_begin = Math.max(ax, bx) >= 0 && Math.max(ay, by) >= 0;
    return after_begin && Math.min(ax, bx) <= this.width && Math.min(ay, by) <= this.height;
  }
  // The cell of a node in whole pixels, so that neighbours meet without a seam.
  cell(node) {
    const { scale, dx, dy } = this.view;
    const [x, y] = [this.world.x[node], this.world.y[node]];
    const left = Math.round((x - 0.5) * scale + dx);
    const top = Math.round((y - 0.5) * scale + dy);
    return [left, top, Math.round((x + 0.5) * scale + dx) - left, Math.round((y + 0.5) * scale + dy) - top];
  }
}

function disc(context, x, y, radius) {
  if (radius < 1.5) {
    context.fillRect(x - radius, y - radius, 2 * radius, 2 * radius);
    return;
  }
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

class WorldLayer {
  constructor(world) {
    this.world = world;
    this.canvas = document.createElement('canvas');
    this.nodes = new Uint32Array(world.node_count).map((_, node) => node);
    this.cells = null; // a picture with one pixel per cell
  }

  forget_colours() {
    this.cells = null;
  }

  draw(view, width, height, sizes) {
    clear_canvas(this.canvas, width, height);
    this.context = this.canvas.getContext('2d');
    this.projection = new Projection(this.world, view, width, height);
    this.sizes = sizes;
    if (this.world.is_grid) {
      this.draw_cells();
    } else {
      const labelled = labelled_nodes(this.projection, sizes);
      draw_graph(this.context, this.projection, sizes, { nodes: this.nodes, edges: this.world.edges, labelled });
    }
  }

  cell_picture() {
    const { rows, cols, blocked } = this.world;
    const canvas = document.createElement('canvas');
    canvas.width = cols;
    canvas.height = rows;
    const context = canvas.getContext('2d');
    context.fillStyle = theme.get('free');
    context.fillRect(0, 0, cols, rows);
    context.fillStyle = theme.get('blocked');
    blocked.forEach((is_blocked, node) => {
      if (is_blocked) context.fillRect(node % cols, Math.floor(node / cols), 1, 1);
    });
    return canvas;
  }

  draw_cells() {
    const { world, context, sizes } = this;
    const { view, width, height } = this.projection;
    this.cells ??= this.cell_picture();
    const left = Math.round(view.dx);
    const top = Math.round(view.dy);
    const right = Math.round(view.dx + world.cols * view.scale);
    const bottom = Math.round(view.dy + world.rows * view.scale);
    context.imageSmoothingEnabled = view.scale < 1;
    context.drawImage(this.cells, left, top, right - left, bottom - top);
    context.strokeStyle = theme.get('grid-line');
    context.lineWidth = sizes.ratio;
    if (sizes.spacing >= 2 * kLineCell) {
      context.beginPath();
      for (let col = 0; col <= world.cols; ++col) {
        const x = Math.round(view.dx + col * view.scale);
        if (x < 0 || x > width) continue;
        context.moveTo(x, top);
        context.lineTo(x, bottom);
      }
      for (let row = 0; row <= world.rows; ++row) {
        const y = Math.round(view.dy + row * view.scale);
        if (y < 0 || y > height) continue;
        context.moveTo(left, y);
        context.lineTo(right, y);
      }
      context.stroke();
    } else {
      context.strokeRect(left, top, right - left, bottom - top);
    }
  }
}

// Part of a graph: nodes, edges as in World.edges, and those of the nodes that have their labels beside them.
function draw_graph(context, projection, sizes, { nodes, edges, labelled }) {
  const { world } = projection;
  context.strokeStyle = theme.get('edge');
  context.lineWidth = sizes.edge;
  draw_edges(context, projection, edges);
  if (world.directed && sizes.spacing > 18 && world.edges.length / 2 <= kMostArrows) {
    context.fillStyle = theme.get('edge');
    for (let i = 0; i < edges.length; i += 2) draw_arrow_head(context, projection, edges[i], edges[i + 1], sizes);
  }
  const [free, blocked] = [theme.get('node'), theme.get('edge')];
  for (const node of nodes) {
    if (!projection.sees(node, sizes.node)) continue;
    context.fillStyle = world.blocked[node] ? blocked : free;
    disc(context, projection.x(node), projection.y(node), node_radius(world, node, sizes));
  }
  draw_labels(context, projection, sizes, labelled);
}

function draw_edges(context, projection, edges) {
  for (let begin = 0; begin < edges.length; begin += 2 * kEdgesPerStroke) {
    context.beginPath();
    const end = Math.min(begin + 2 * kEdgesPerStroke, edges.length);
    for (let i = begin; i < end; i += 2) {
      if (!projection.sees_line(edges[i], edges[i + 1])) continue;
      context.moveTo(projection.x(edges[i]), projection.y(edges[i]));
      context.lineTo(projection.x(edges[i + 1]), projection.y(edges[i + 1]));
    }
    context.stroke();
  }
}

// The nodes that have room for their labels.
function labelled_nodes(projection, sizes) {
  const { world } = projection;
  const nodes = [];
  if (!world.labels || sizes.spacing <= 34) return nodes;
  for (let node = 0; node < world.node_count && nodes.length < kMostLabels; ++node) {
    if (projection.sees(node, 0)) nodes.push(node);
  }
  return nodes;
}

function draw_labels(context, projection, sizes, nodes) {
  const { world } = projection;
  context.fillStyle = theme.get('muted');
  context.font = `${11 * sizes.ratio}px system-ui, sans-serif`;
  context.textBaseline = 'middle';
  for (const node of nodes) {
    const text = String(world.labels[node]).slice(0, 24);
    const away = node_radius(world, node, sizes) + 3 * sizes.ratio;
    const fits = projection.x(node) + away + context.measureText(text).width < projection.width;
    context.textAlign = fits ? 'left' : 'right';
    context.fillText(text, projection.x(node) + (fits ? away : -away), projection.y(node));
  }
}

// Where prizes differ, a node's area says its prize.
function node_radius(world, node, sizes) {
  if (!world.prizes || world.total_prize <= 0) return sizes.node;
  const mean = world.total_prize / world.valid_count;
  return sizes.node * clamp(Math.sqrt(world.prizes[node] / mean), 0.5, 2.2);
}

// A head two thirds along the line from a to b.
function draw_arrow_head(context, projection, a, b, sizes) {
  if (!projection.sees_line(a, b)) return;
  const [ax, ay] = [projection.x(a), projection.y(a)];
  const [dx, dy] = [projection.x(b) - ax, projection.y(b) - ay];
  const length = Math.hypot(dx, dy);
  const size = 4 * sizes.ratio;
  if (length < 4 * size) return;
  const [ux, uy] = [dx / length, dy / length];
  const [x, y] = [ax + 0.67 * dx, ay + 0.67 * dy];
  context.beginPath();
  context.moveTo(x + size * ux, y + size * uy);
  context.lineTo(x - size * (ux + 0.6 * uy), y - size * (uy - 0.6 * ux));
  context.lineTo(x - size * (ux - 0.6 * uy), y - size * (uy + 0.6 * ux));
  context.fill();
}

// What a walk has changed up to a step, drawn by draw(from, to). A later step is drawn onto the picture; an earlier one
// starts from the nearest checkpoint, a copy of the picture kept on the way. Steps drawn per change are bounded by the
// distance between checkpoints, or by the steps gone forward.
class StepLayer {
  constructor(world, trail) {
    this.world = world;
    this.trail = trail;
    this.canvas = document.createElement('canvas');
    this.every = Math.max(kCheckpointEvery, Math.ceil(trail.nodes.length / (kMostCheckpoints + 1)));
  }

  reset(view, width, height, sizes) {
    clear_canvas(this.canvas, width, height);
    this.context = this.canvas.getContext('2d');
    this.projection = new Projection(this.world, view, width, height);
    this.sizes = sizes;
    this.checkpoints = [];
    this.drawn = -1;
  }

  show(step) {
    if (step < this.drawn) this.go_back(step);
    while (this.drawn < step) {
      const checkpoint = Math.floor(this.drawn / this.every) + 1;
      const to = Math.min(step, Math.max(checkpoint * this.every, 0));
      this.draw(this.drawn + 1, to);
      this.drawn = to;
      if (checkpoint > 0 && to === checkpoint * this.every) this.keep(checkpoint);
    }
  }

  keep(checkpoint) {
    if (this.checkpoints[checkpoint]) return;
    const copy = document.createElement('canvas');
    copy.width = this.canvas.width;
    copy.height = this.canvas.height;
    copy.getContext('2d').drawImage(this.canvas, 0, 0);
    this.checkpoints[checkpoint] = copy;
  }

  go_back(step) {
    const checkpoint = Math.floor(step / this.every);
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.drawn = -1;
    if (!this.checkpoints[checkpoint]) return;
    this.context.drawImage(this.checkpoints[checkpoint], 0, 0);
    this.drawn = checkpoint * this.every;
  }
}

// The fog over what has not been seen yet: the shape of the world in one colour, out of which the steps take what they
// show.
class FogLayer extends StepLayer {
  reset(view, width, height, sizes, world_canvas) {
    super.reset(view, width, height, sizes);
    this.world_canvas = world_canvas;
    this.labelled = new Set(this.world.is_grid ? [] : labelled_nodes(this.projection, sizes));
  }

  draw(from, to) {
    if (from === 0) this.cover();
    const { context, projection, trail, world } = this;
    const nodes = trail.discovery.nodes.shown(from, to);
    if (world.is_grid) {
      for (const node of nodes) {
        if (projection.sees(node, projection.view.scale)) context.clearRect(...projection.cell(node));
      }
      return;
    }
    const edges = trail.discovery.edges_shown(from, to);
    const labelled = nodes.filter((node) => this.labelled.has(node));
    context.globalCompositeOperation = 'destination-out';
    draw_graph(context, projection, this.sizes, { nodes, edges, labelled });
    context.globalCompositeOperation = 'source-over';
  }

  cover() {
    const { context, canvas, world } = this;
    context.drawImage(this.world_canvas, 0, 0);
    context.globalCompositeOperation = 'source-in';
    context.fillStyle = theme.get(world.is_grid ? 'fog' : 'faint');
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.globalCompositeOperation = 'source-over';
  }
}

// The walk, coloured by order.
class TrailLayer extends StepLayer {
  reset(view, width, height, sizes, scale) {
    super.reset(view, width, height, sizes);
    this.scale = scale;
  }

  // Draws the steps from..to, one stretch of equal colour after another.
  draw(from, to) {
    this.context.lineCap = 'round';
    this.context.lineJoin = 'round';
    this.context.lineWidth = this.sizes.line;
    for (let begin = from; begin <= to; ) {
      const band = this.trail.band(begin);
      let end = begin;
      while (end < to && this.trail.band(end + 1) === band) ++end;
      if (this.world.is_grid) this.fill_cells(begin, end, this.scale[band]);
      if (!this.sizes.fills) this.stroke(begin, end, this.scale[band]);
      if (!this.world.is_grid) this.fill_nodes(begin, end);
      begin = end + 1;
    }
  }

  fill_cells(begin, end, colour) {
    const { context, projection, trail } = this;
    context.fillStyle = colour;
    context.globalAlpha = this.sizes.fills ? 1 : kTint;
    for (let step = begin; step <= end; ++step) {
      const node = trail.nodes[step];
      if (trail.first_visit[node] !== step || !projection.sees(node, projection.view.scale)) continue;
      context.fillRect(...projection.cell(node));
    }
    context.globalAlpha = 1;
  }

  stroke(begin, end, colour) {
    const { context, projection, trail } = this;
    context.strokeStyle = colour;
    context.beginPath();
    for (let step = Math.max(begin, 1); step <= end; ++step) {
      const [a, b] = [trail.nodes[step - 1], trail.nodes[step]];
      if (a === b || !projection.sees_line(a, b)) continue;
      const from = this.passing(step - 1);
      context.moveTo(...from.arriving);
      context.lineTo(...from.leaving);
      context.lineTo(...this.passing(step).arriving);
    }
    context.stroke();
  }

  // Nodes lie over the lines, those of the step before too.
  fill_nodes(begin, end) {
    const { context, projection, trail, world, sizes } = this;
    for (let step = Math.max(begin - 1, 0); step <= end; ++step) {
      const node = trail.nodes[step];
      if (!projection.sees(node, 2 * sizes.node)) continue;
      context.fillStyle = this.scale[trail.band(trail.first_visit[node])];
      disc(context, projection.x(node), projection.y(node), node_radius(world, node, sizes));
    }
  }

  // The unit direction of a step in the picture, or null at the ends of the walk and where a move was blocked.
  direction(step) {
    if (step < 1 || step > this.trail.last) return null;
    const [a, b] = [this.trail.nodes[step - 1], this.trail.nodes[step]];
    const dx = this.world.x[b] - this.world.x[a];
    const dy = this.world.y[b] - this.world.y[a];
    const length = Math.hypot(dx, dy);
    return length > 0 ? [dx / length, dy / length] : null;
  }

  // Where the line passes a node, kept to the right by a lane so that the way there does not hide the way back. In a
  // turn, the two lanes meet; where the walk turns round, it arrives on one side and leaves on the other.
  passing(step) {
    const node = this.trail.nodes[step];
    const [x, y] = [this.projection.x(node), this.projection.y(node)];
    const lane = this.sizes.lane;
    if (lane === 0) return { arriving: [x, y], leaving: [x, y] };
    const came = this.direction(step) ?? this.direction(step + 1) ?? [0, 0];
    const goes = this.direction(step + 1) ?? came;
    const cosine = came[0] * goes[0] + came[1] * goes[1];
    if (cosine < -0.5) {
      return {
        arriving: [x - lane * came[1], y + lane * came[0]],
        leaving: [x - lane * goes[1], y + lane * goes[0]],
      };
    }
    const reach = lane / (1 + cosine);
    const both = [x - reach * (came[1] + goes[1]), y + reach * (came[0] + goes[0])];
    return { arriving: both, leaving: both };
  }
}
