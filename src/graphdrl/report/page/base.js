// Small helpers that all parts use.

// An error in the data, as one line for the reader.
class DataError extends Error {}

function check(condition, message) {
  if (!condition) throw new DataError(message);
}

const $ = (id) => document.getElementById(id);

// An element. Text goes in as text: nothing in the data is ever read as HTML.
function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

function fill_select(select, names, chosen) {
  select.replaceChildren(...names.map((name, index) => new Option(name, String(index), false, index === chosen)));
}

const kDash = '–';

// A number with at most this many decimals, without zeros at its end.
function plain(value, decimals = 2) {
  return Number(value).toLocaleString('en', { maximumFractionDigits: decimals });
}

// A number with exactly this many decimals, or a dash for null.
function fixed(value, decimals = 1) {
  return typeof value === 'number' && Number.isFinite(value) ? value.toFixed(decimals) : kDash;
}

// A metric's value, to four significant digits.
function significant(value) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(2);
  return plain(value, Math.max(0, 3 - Math.floor(Math.log10(size))));
}

const plural = (count, noun) => `${plain(count)} ${noun}${count === 1 ? '' : 's'}`;

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

const is_number = (value) => typeof value === 'number' && Number.isFinite(value);

// The last index in a sorted list whose value is at most `value`, or -1.
function last_at_most(sorted, value) {
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// Runs a part of the page; a mistake in the data becomes one line in `place`.
function guarded(place, what, action) {
  try {
    return action();
  } catch (error) {
    show_problem(place, `${what}: ${error.message}`);
    if (!(error instanceof DataError)) console.error(error);
    return null;
  }
}

function show_problem(place, message) {
  place.append(element('p', { className: 'problem', textContent: message }));
}
