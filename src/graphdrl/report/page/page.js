// The page as a whole: reads the data, shows what there is, and in watch mode asks for news.

const kVersion = 1;
const kWatchEveryMs = 2000;
const kWatchPatienceMs = 10000;
const kSections = { replays: 'Replays', runs: 'Runs', evaluations: 'Evaluations' };

function parse_data(text) {
  let data = null;
  try {
    data = JSON.parse(text);
  } catch (error) {
    throw new DataError(`it is not JSON: ${error.message}`);
  }
  check(data && typeof data === 'object', 'it is not an object');
  check(data.version === kVersion, `its version is ${data.version}, and this page reads version ${kVersion}`);
  for (const name of Object.keys(kSections)) {
    check(data[name] === undefined || Array.isArray(data[name]), `"${name}" is not a list`);
  }
  return data;
}

class Page {
  constructor() {
    this.parts = { replays: new Player(), runs: new Runs(), evaluations: new Evaluations() };
  }

  show(text) {
    const problems = $('problems');
    problems.replaceChildren();
    guarded(problems, 'The data of this page cannot be read', () => {
      const data = parse_data(text);
      if (data.title) document.title = $('title').textContent = String(data.title);
      this.show_sections(data);
      for (const [name, title] of Object.entries(kSections)) {
        guarded(problems, title, () => this.parts[name].update(data[name] ?? []));
      }
      if (data.watch) this.watch();
    });
  }

  show_sections(data) {
    const present = Object.keys(kSections).filter((name) => data[name]?.length > 0);
    for (const name of Object.keys(kSections)) $(name).hidden = !present.includes(name);
    const links = present.map((name) => element('li', {}, element('a', { href: `#${name}` }, kSections[name])));
    $('contents').replaceChildren(element('ul', {}, ...links));
    $('contents').hidden = present.length < 2;
    if (present.length > 0) return;
    show_problem($('problems'), data.watch ? 'There is nothing to show yet.' : 'There is nothing in this report.');
  }

  watch() {
    if (this.watching) return;
    this.watching = true;
    this.seen = new Date();
    this.show_watch(true);
    setTimeout(() => this.ask(), kWatchEveryMs);
  }

  async ask() {
    try {
      const answer = await fetch('data.json', { cache: 'no-store', signal: AbortSignal.timeout(kWatchPatienceMs) });
      check(answer.ok, `the server answers ${answer.status}`);
      const text = await answer.text();
      this.seen = new Date();
      if (text !== this.text) {
        this.text = text;
        this.changed = this.seen;
        this.show(text);
      }
      this.show_watch(true);
    } catch {
      this.show_watch(false);
    }
    setTimeout(() => this.ask(), kWatchEveryMs);
  }

  // Readers who hear the page are told of a change of state, not of every answer.
  show_watch(alive) {
    const line = $('watch');
    const time = (date) => date.toLocaleTimeString('en-GB');
    line.hidden = false;
    line.setAttribute('aria-live', alive === this.alive ? 'off' : 'polite');
    line.classList.toggle('gone', !alive);
    line.textContent = alive
      ? `Watching. Last updated at ${time(this.changed ?? this.seen)}, last asked at ${time(this.seen)}.`
      : `The server has not answered since ${time(this.seen)}. Trying again every ${kWatchEveryMs / 1000} seconds.`;
    this.alive = alive;
  }
}

function start() {
  theme.recall();
  set_up_charts();
  theme.on_change(colour_charts);
  theme.apply();
  theme.system.addEventListener('change', () => theme.apply());
  $('theme').addEventListener('click', () => theme.toggle());
  new Page().show($('data').textContent);
}

addEventListener('error', (event) => show_problem($('problems'), `Something went wrong: ${event.message}`));
start();
