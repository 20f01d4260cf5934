// The replays: which plans are on show, and the clock that drives them.

const kSpeeds = [1, 2, 5, 10, 20, 50, 100, 250, 500, 1000, 2500, 5000, 10000, 25000]; // steps per second
const kUsualLengthS = 15; // of a whole replay at the speed first chosen
const kCalmUpdatesPerS = 2; // where the reader asks for little motion
const kSpeakAfterMs = 500;
const kPlayShape = 'M4 2.5v11L13 8z';
const kPauseShape = 'M4 3h3v10H4zM9 3h3v10H9z';
const kNone = -1;

class Player {
  constructor() {
    this.replays = [];
    this.panes = [];
    this.chosen = { replay: 0, plans: [0, kNone] };
    this.tick = 0;
    this.playing = false;
    this.listen();
  }

  // Takes the replays of new data; stays where it was if they still begin the same.
  update(replays) {
    const before = this.replays[this.chosen.replay];
    const text = JSON.stringify(replays);
    if (text === this.text) return;
    this.text = text;
    const problems = $('replay-problems');
    problems.replaceChildren();
    this.replays = replays
      .map((replay, i) => guarded(problems, `Replay ${i + 1}`, () => read_replay(replay, i)))
      .filter((replay) => replay !== null);
    $('player').hidden = this.replays.length === 0;
    if (this.replays.length === 0) {
      this.pause();
      return;
    }
    const same = before ? this.replays.findIndex((replay) => replay.title === before.title) : -1;
    if (same >= 0) this.come_back(same);
    else this.choose_replay(0);
    this.fill_replays();
  }

  fill_replays() {
    fill_select($('replay'), this.replays.map((replay) => replay.title), this.chosen.replay);
    $('replay-field').hidden = this.replays.length === 1;
  }

  // Shows the same plans of a replay that has changed, at the same cost.
  come_back(index) {
    const cost = this.clock.costs[this.tick];
    const { playing, speed } = this;
    const count = this.replays[index].trails.length;
    const [first, second] = this.chosen.plans;
    this.chosen.replay = index;
    this.choose_plans(Math.min(first, count - 1), second < count ? second : kNone);
    this.set_speed(speed);
    this.go_to(Math.max(0, last_at_most(this.clock.costs, cost)));
    if (playing) this.play();
  }

  choose_replay(index) {
    this.chosen.replay = index;
    this.choose_plans(0, this.replays[index].trails.length > 1 ? 1 : kNone);
    const usual = this.clock.last / kUsualLengthS;
    this.set_speed(clamp(kSpeeds.findIndex((speed) => speed >= usual), 0, kSpeeds.length - 1));
  }

  choose_plans(first, second) {
    this.pause();
    const { world, trails } = this.replays[this.chosen.replay];
    this.chosen.plans = [first, second];
    const names = trails.map((trail) => trail.policy);
    fill_select($('plan-0'), names, first);
    fill_select($('plan-1'), ['none', ...names], second + 1);
    $('compare-field').hidden = trails.length === 1;
    for (const pane of this.panes) pane.close();
    const shown = this.chosen.plans.filter((index) => index !== kNone).map((index) => trails[index]);
    const viewport = new Viewport(world);
    this.panes = shown.map((trail, i) => new Pane(world, trail, viewport, i, shown.length === 1));
    $('panes').replaceChildren(...this.panes.map((pane) => pane.root));
    $('panes').classList.toggle('panes-two', shown.length === 2);
    $('fog-field').hidden = shown.every((trail) => trail.discovery === null);
    this.set_fog();
    this.clock = new Clock(shown);
    this.chart = new ProgressChart(world, shown);
    $('scrubber').max = this.clock.last;
    this.go_to(0);
  }

  go_to(tick) {
    this.tick = clamp(tick, 0, this.clock.last);
    this.panes.forEach((pane, i) => pane.show(this.clock.steps[i][this.tick]));
    $('scrubber').value = this.tick;
    this.chart.show(this.clock.costs[this.tick]);
    if (!this.playing) this.speak_soon();
  }

  set_fog() {
    for (const pane of this.panes) pane.set_fog($('fog').checked);
  }

  // Says where the walks are once the reader has stopped moving.
  speak_soon() {
    clearTimeout(this.speech);
    this.speech = setTimeout(() => {
      const text = this.panes.map((pane) => pane.spoken()).join(' ');
      $('said').textContent = text;
      $('scrubber').setAttribute('aria-valuetext', text);
    }, kSpeakAfterMs);
  }

  set_speed(index) {
    this.speed = clamp(index, 0, kSpeeds.length - 1);
    $('speed').value = String(this.speed);
  }

  play() {
    if (this.tick === this.clock.last) this.go_to(0);
    this.playing = true;
    this.show_playing();
    let before = performance.now();
    let due = 0; // ticks, with a fraction
    const advance = (now) => {
      if (!this.playing) return;
      const elapsed_s = Math.max(0, now - before) / 1000;
      if (!calm_motion.matches || elapsed_s >= 1 / kCalmUpdatesPerS) {
        before = now;
        due += Math.min(elapsed_s, 1) * kSpeeds[this.speed];
        if (due >= 1) this.go_to(this.tick + Math.floor(due));
        due %= 1;
      }
      if (this.tick === this.clock.last) this.pause();
      else this.frame = requestAnimationFrame(advance);
    };
    this.frame = requestAnimationFrame(advance);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.show_playing();
    this.speak_soon();
  }

  show_playing() {
    $('play').setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    $('play-shape').setAttribute('d', this.playing ? kPauseShape : kPlayShape);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  jump(tick) {
    this.pause();
    this.go_to(tick);
  }

  listen() {
    const on_click = (id, action) => $(id).addEventListener('click', action);
    on_click('to-begin', () => this.jump(0));
    on_click('step-back', () => this.jump(this.tick - 1));
    on_click('play', () => this.toggle());
    on_click('step-forward', () => this.jump(this.tick + 1));
    on_click('to-end', () => this.jump(this.clock.last));
    $('scrubber').addEventListener('input', () => this.jump(Number($('scrubber').value)));
    fill_select($('speed'), kSpeeds.map((speed) => `${plain(speed)} ${speed === 1 ? 'step' : 'steps'}/s`), 0);
    $('speed').addEventListener('change', () => this.set_speed(Number($('speed').value)));
    $('replay').addEventListener('change', () => this.choose_replay(Number($('replay').value)));
    for (const id of ['plan-0', 'plan-1']) {
      $(id).addEventListener('change', () => {
        this.choose_plans(Number($('plan-0').value), Number($('plan-1').value) - 1);
      });
    }
    $('fog').addEventListener('change', () => this.set_fog());
    $('player').addEventListener('keydown', (event) => this.key(event));
    theme.on_change(() => this.recolour());
  }

  // What a key does, unless what has the focus needs it itself.
  key(event) {
    const { target, key } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches('select, summary')) return;
    if (event.shiftKey && this.pan(target, key)) {
      event.preventDefault();
      return;
    }
    const actions = {
      ' ': () => this.toggle(),
      ArrowLeft: () => this.jump(this.tick - 1),
      ArrowRight: () => this.jump(this.tick + 1),
      Home: () => this.jump(0),
      End: () => this.jump(this.clock.last),
      '+': () => this.set_speed(this.speed + 1),
      '=': () => this.set_speed(this.speed + 1),
      '-': () => this.set_speed(this.speed - 1),
      '−': () => this.set_speed(this.speed - 1),
    };
    if (!actions[key] || (key === ' ' && target.matches('button, [type="checkbox"]'))) return;
    event.preventDefault();
    actions[key]();
  }

  pan(target, key) {
    const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const pane = this.panes.find(({ map }) => map.canvas === target);
    if (!pane || !ways[key]) return false;
    pane.map.pan(...ways[key]);
    return true;
  }

  recolour() {
    for (const pane of this.panes) pane.recolour();
    if (!this.chart) return;
    this.chart.draw();
    this.chart.show(this.clock.costs[this.tick]);
  }
}

function read_replay(replay, index) {
  const world = new World(replay.world);
  check(Array.isArray(replay.plans) && replay.plans.length > 0, 'there is no plan');
  const trails = replay.plans.map((plan) => new Trail(world, plan, replay.budget));
  return { title: String(replay.title ?? (world.name || `Replay ${index + 1}`)), world, trails };
}
