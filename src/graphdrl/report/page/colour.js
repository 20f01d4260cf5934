// Colours: the two themes, the scale along a walk, and the colours of runs and policies.

// OKLCH to linear sRGB [Ottosson 2020, "A perceptual color space for image processing"]. Hue in degrees.
function oklch_to_linear(lightness, chroma, hue) {
  const a = chroma * Math.cos((hue * Math.PI) / 180);
  const b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

const in_gamut = (channels) => channels.every((value) => value >= -1e-4 && value <= 1 + 1e-4);

const gamma = (value) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);

// A CSS colour. If sRGB lacks that much chroma, takes the most it has; lightness and hue stay.
function oklch(lightness, chroma, hue) {
  let low = 0;
  let high = chroma;
  if (in_gamut(oklch_to_linear(lightness, chroma, hue))) {
    low = chroma;
  } else {
    for (let i = 0; i < 12; ++i) {
      const middle = (low + high) / 2;
      if (in_gamut(oklch_to_linear(lightness, middle, hue))) low = middle;
      else high = middle;
    }
  }
  const bytes = oklch_to_linear(lightness, low, hue).map((value) => Math.round(255 * gamma(clamp(value, 0, 1))));
  return `#${bytes.map((byte) => byte.toString(16).padStart(2, '0')).join('')}`;
}

const kBands = 256; // colours along a walk

// From blue-violet over green to yellow: equal steps in OKLCH's lightness and hue, so that equal stretches of a walk
// differ equally. The range of lightness keeps both ends apart from the theme's ground.
function walk_scale(dark) {
  const [first, last] = dark ? [0.56, 0.9] : [0.4, 0.74];
  return Array.from({ length: kBands }, (_, i) => {
    const t = i / (kBands - 1);
    return oklch(first + t * (last - first), 0.16, 285 - t * 185);
  });
}

const kSeriesHues = [268, 50, 150, 350, 95, 215, 20, 310];
const kSeriesDashes = [[], [7, 4], [2, 3]];
const kDashNames = ['', 'dashed', 'dotted'];

// The look of series number i. Hues repeat after eight, with another dash, so that no two look the same.
function series_style(i, dark) {
  const turn = Math.floor(i / kSeriesHues.length) % kSeriesDashes.length;
  return {
    colour: oklch(dark ? 0.76 : 0.53, 0.15, kSeriesHues[i % kSeriesHues.length]),
    dash: kSeriesDashes[turn],
    dash_name: kDashNames[turn],
  };
}

// The theme: the reader's choice, else the system's.
const theme = {
  listeners: [],
  system: matchMedia('(prefers-color-scheme: dark)'),
  chosen: null,
  get dark() {
    return this.chosen ? this.chosen === 'dark' : this.system.matches;
  },
  get(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  },
  on_change(listener) {
    this.listeners.push(listener);
  },
  apply() {
    document.documentElement.dataset.theme = this.dark ? 'dark' : 'light';
    $('theme').textContent = this.dark ? 'Light theme' : 'Dark theme';
    for (const listener of this.listeners) listener();
  },
  toggle() {
    this.chosen = this.dark ? 'light' : 'dark';
    this.remember();
    this.apply();
  },
  // Some browsers keep nothing for files; the choice then holds until the page is closed.
  remember() {
    try {
      localStorage.setItem('graphdrl-theme', this.chosen);
    } catch {
      return;
    }
  },
  recall() {
    try {
      const stored = localStorage.getItem('graphdrl-theme');
      if (stored === 'dark' || stored === 'light') this.chosen = stored;
    } catch {
      this.chosen = null;
    }
  },
};

const calm_motion = matchMedia('(prefers-reduced-motion: reduce)');
