// A map on a canvas: the world, the walk up to a step, and marks; with zoom and movement.

const kMostHeight = 560; // CSS pixels
const kMostOfWindow = 0.55;
const kMostRatio = 2; // device pixels per CSS pixel: more only costs time
const kMostZoom = 400;
const kSettleMs = 140; // after the last movement, the map is drawn sharply again
const kScoresShown = 8;

// What part of the world is seen: shared by maps side by side. Zoom 1 is the whole world.
class Viewport {
  constructor(world) {
    this.world = world;
    this.listeners = [];
    this.moving = false;
    this.fit();
  }

  fit() {
    const { box } = this.world;
    this.zoom = 1;
    this.x = (box.left + box.right) / 2;
    this.y = (box.top + box.bottom) / 2;
    this.changed();
  }

  changed() {
    for (const listener of this.listeners) listener();
  }

  // Between two of these calls the old pictures are moved and stretched, which is fast at any size of world.
  moved() {
    this.moving = true;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.moving = false;
      this.changed();
    }, kSettleMs);
    this.changed();
  }

  // Zooms so that the place (x, y) of the world stays where it is.
  zoom_at(factor, x, y) {
    const zoom = clamp(this.zoom * factor, 1, kMostZoom);
    const share = 1 - this.zoom / zoom;
    this.zoom = zoom;
    this.move_to(this.x + (x - this.x) * share, this.y + (y - this.y) * share);
  }

  move_to(x, y) {
    const { box } = this.world;
    const half_width = (box.right - box.left) / 2 / this.zoom;
    const half_height = (box.bottom - box.top) / 2 / this.zoom;
    this.x = clamp(x, box.left + half_width, box.right - half_width);
    this.y = clamp(y, box.top + half_height, box.bottom - half_height);
    this.moved();
  }
}

class MapView {
  constructor(canvas, world, trail, viewport, on_point) {
    Object.assign(this, { canvas, world, trail, viewport, on_point });
    this.step = 0;
    this.fogged = false;
    this.world_layer = new WorldLayer(world);
    this.fog_layer = trail.discovery ? new FogLayer(world, trail) : null;
    this.trail_layer = new TrailLayer(world, trail);
    this.drawn_view = null;
    viewport.listeners.push(() => this.request());
    this.observer = new ResizeObserver(() => this.request());
    this.observer.observe(canvas.parentElement);
    this.listen();
  }

  close() {
    this.observer.disconnect();
    cancelAnimationFrame(this.frame);
  }

  show(step) {
    this.step = step;
    this.request();
  }

  // Whether the fog is shown, where the walk has any.
  set_fog(on) {
    this.fogged = on && this.fog_layer !== null;
    this.request();
  }

  recolour() {
    this.world_layer.forget_colours();
    this.drawn_view = null;
    this.request();
  }

  request() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      this.draw();
    });
  }

  // Fits the canvas to its box. The drawing is gone when the size changes.
  fit_canvas() {
    const { box } = this.world;
    const width = this.canvas.parentElement.clientWidth;
    const shape = (box.bottom - box.top) / (box.right - box.left);
    const height = Math.round(clamp(width * shape, 120, this.most_height()));
    this.ratio = Math.min(devicePixelRatio || 1, kMostRatio);
    this.canvas.style.height = `${height}px`;
    const pixels = [Math.round(width * this.ratio), Math.round(height * this.ratio)];
    if (this.canvas.width === pixels[0] && this.canvas.height === pixels[1]) return;
    [this.canvas.width, this.canvas.height] = pixels;
    this.drawn_view = null;
  }

  // Leaves room for the controls below. Phones change the window's height while they scroll.
  most_height() {
    return Math.min(kMostHeight, Math.max(240, kMostOfWindow * screen.availHeight, kMostOfWindow * innerHeight));
  }

  view() {
    const { box } = this.world;
    const { width, height } = this.canvas;
    const room = 1 - (4 * this.ratio) / Math.max(width, height, 1);
    const scale = room * this.viewport.zoom * Math.min(width / (box.right - box.left), height / (box.bottom - box.top));
    return { scale, dx: width / 2 - this.viewport.x * scale, dy: height / 2 - this.viewport.y * scale };
  }

  draw() {
    this.fit_canvas();
    if (this.canvas.width === 0) return;
    const view = this.view();
    if (!this.drawn_view || (!this.viewport.moving && !same_view(view, this.drawn_view))) this.draw_layers(view);
    this.trail_layer.show(this.step);
    if (this.fogged) this.fog_layer.show(this.step);
    const context = this.canvas.getContext('2d');
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.copy(context, this.world_layer.canvas, view);
    if (this.fogged) this.copy(context, this.fog_layer.canvas, view);
    this.copy(context, this.trail_layer.canvas, view);
    draw_marks(context, new Projection(this.world, view, this.canvas.width, this.canvas.height), this);
    this.canvas.style.touchAction = this.viewport.zoom > 1 ? 'none' : 'pan-x pan-y';
  }

  draw_layers(view) {
    const { width, height } = this.canvas;
    const sizes = sizes_of(this.world, view, this.ratio);
    this.world_layer.draw(view, width, height, sizes);
    this.fog_layer?.reset(view, width, height, sizes, this.world_layer.canvas);
    this.trail_layer.reset(view, width, height, sizes, walk_scale(theme.dark));
    this.drawn_view = view;
  }

  // Copies a layer, which was drawn in one view, into another.
  copy(context, layer, view) {
    const from = this.drawn_view;
    const stretch = view.scale / from.scale;
    const [dx, dy] = [view.dx - from.dx * stretch, view.dy - from.dy * stretch];
    context.drawImage(layer, dx, dy, layer.width * stretch, layer.height * stretch);
  }

  sizes() {
    return sizes_of(this.world, this.view(), this.ratio);
  }

  // The place of the world under a pointer.
  place(event) {
    const frame = this.canvas.getBoundingClientRect();
    const view = this.view();
    return {
      x: ((event.clientX - frame.left) * this.ratio - view.dx) / view.scale,
      y: ((event.clientY - frame.top) * this.ratio - view.dy) / view.scale,
    };
  }

  node_at({ x, y }) {
    if (this.world.is_grid) {
      const [row, col] = [Math.floor(y), Math.floor(x)];
      const inside = row >= 0 && col >= 0 && row < this.world.rows && col < this.world.cols;
      return inside ? row * this.world.cols + col : -1;
    }
    let best = -1;
    let least = ((14 * this.ratio) / this.view().scale) ** 2;
    for (let node = 0; node < this.world.node_count; ++node) {
      const distance = (this.world.x[node] - x) ** 2 + (this.world.y[node] - y) ** 2;
      if (distance >= least) continue;
      best = node;
      least = distance;
    }
    return best;
  }

  listen() {
    const pointers = new Map();
    const { canvas } = this;
    canvas.addEventListener('pointerdown', (event) => {
      pointers.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
      this.on_point(this.node_at(this.place(event)));
    });
    canvas.addEventListener('pointermove', (event) => {
      if (pointers.has(event.pointerId)) this.drag(pointers, event);
      else this.on_point(this.node_at(this.place(event)));
    });
    for (const name of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    }
    canvas.addEventListener('pointerleave', () => this.on_point(-1));
    canvas.addEventListener('dblclick', (event) => this.zoom(2, this.place(event)));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
  }

  // One pointer moves the map, two also stretch it.
  drag(pointers, event) {
    const old = pointers.get(event.pointerId);
    pointers.set(event.pointerId, event);
    const [from, to] = [this.place(old), this.place(event)];
    if (pointers.size === 2) {
      const other = [...pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId);
      const distance = (a) => Math.hypot(a.clientX - other.clientX, a.clientY - other.clientY);
      const clientX = (event.clientX + other.clientX) / 2;
      const clientY = (event.clientY + other.clientY) / 2;
      const middle = this.place({ clientX, clientY });
      this.viewport.zoom_at(distance(event) / Math.max(distance(old), 1), middle.x, middle.y);
    }
    const share = 1 / pointers.size;
    this.viewport.move_to(this.viewport.x + share * (from.x - to.x), this.viewport.y + share * (from.y - to.y));
  }

  // A plain wheel scrolls the page, unless the map has been chosen.
  wheel(event) {
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== this.canvas) return;
    event.preventDefault();
    this.zoom(1.0015 ** -event.deltaY, this.place(event));
  }

  zoom(factor, place = this.viewport) {
    this.viewport.zoom_at(factor, place.x, place.y);
  }

  // Moves the map by shares of what is seen.
  pan(right, down) {
    const { box } = this.world;
    const { viewport } = this;
    const width = (box.right - box.left) / viewport.zoom;
    const height = (box.bottom - box.top) / viewport.zoom;
    viewport.move_to(viewport.x + 0.2 * right * width, viewport.y + 0.2 * down * height);
  }
}

function same_view(a, b) {
  return a.scale === b.scale && a.dx === b.dx && a.dy === b.dy;
}

// The marks over the walk: scores, what is missed at the end, start, end, and where the walk is.
function draw_marks(context, projection, map) {
  const { trail, step } = map;
  const sizes = map.sizes();
  const at_end = step === trail.last;
  if (at_end) draw_missed(context, projection, map, sizes);
  draw_scores(context, projection, trail.scores(step), sizes);
  draw_mark(context, projection, trail.nodes[0], sizes, 'disc', 'halo');
  if (at_end) draw_mark(context, projection, trail.nodes[trail.last], sizes, 'square', 'halo');
  else draw_mark(context, projection, trail.nodes[step], sizes, 'disc', 'now');
}

function draw_mark(context, projection, node, sizes, shape, fill) {
  const [x, y] = [projection.x(node), projection.y(node)];
  const radius = sizes.mark * (shape === 'disc' ? 0.75 : 0.7);
  context.beginPath();
  if (shape === 'disc') context.arc(x, y, radius, 0, 2 * Math.PI);
  else context.rect(x - radius, y - radius, 2 * radius, 2 * radius);
  context.lineWidth = sizes.ratio * 5;
  context.strokeStyle = theme.get('halo');
  context.stroke();
  context.fillStyle = theme.get(fill);
  context.fill();
  context.lineWidth = sizes.ratio * 2.25;
  context.strokeStyle = theme.get('now');
  context.stroke();
}

// Where there is fog, it says what was not even seen.
function draw_missed(context, projection, { world, trail, fogged }, sizes) {
  const arm = world.is_grid ? clamp(sizes.spacing * 0.18, 0.5, 5) * sizes.ratio : Math.max(sizes.node, 2 * sizes.ratio);
  context.beginPath();
  for (let node = 0; node < world.node_count; ++node) {
    if (world.blocked[node] || trail.first_visit[node] >= 0 || !projection.sees(node, arm)) continue;
    if (fogged && trail.discovery.first_seen[node] < 0) continue;
    const [x, y] = [projection.x(node), projection.y(node)];
    if (arm < 2) {
      context.rect(x - arm, y - arm, 2 * arm, 2 * arm);
    } else {
      context.moveTo(x - arm, y - arm);
      context.lineTo(x + arm, y + arm);
      context.moveTo(x + arm, y - arm);
      context.lineTo(x - arm, y + arm);
    }
  }
  context.lineWidth = arm < 2 ? 1 : sizes.ratio * 2;
  context.strokeStyle = theme.get('missed');
  context.stroke();
}

// Rings round the best moves, numbered as in the list; the better, the stronger.
function draw_scores(context, projection, scores, sizes) {
  if (!scores) return;
  context.strokeStyle = theme.get('accent');
  context.setLineDash([4 * sizes.ratio, 3 * sizes.ratio]);
  scores.slice(0, kScoresShown).forEach(({ node }, place) => {
    const [x, y] = [projection.x(node), projection.y(node)];
    context.lineWidth = sizes.ratio * (place === 0 ? 3 : 1.75);
    context.beginPath();
    context.arc(x, y, sizes.mark * 1.15, 0, 2 * Math.PI);
    context.stroke();
    if (sizes.spacing < 24) return;
    context.fillStyle = theme.get('text');
    context.font = `600 ${clamp(sizes.mark * 1.2, 10 * sizes.ratio, 14 * sizes.ratio)}px system-ui, sans-serif`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(String(place + 1), x, y);
  });
  context.setLineDash([]);
}
