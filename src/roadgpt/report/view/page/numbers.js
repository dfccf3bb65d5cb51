// Numbers: looking things up in columns, colours, texts.

const SCENERY = JSON.parse(document.getElementById("scenery").textContent);

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const mix = (a, b, u) => a + (b - a) * u;
const kmh = (speed) => speed * 3.6;

// Where in rising xs a value lies: index i and share u, so that it is xs[i] + u (xs[i + 1] - xs[i]).
function placeIn(xs, value) {
  let low = 0;
  let high = xs.length - 1;
  if (high < 1 || !(value > xs[0])) return { i: 0, u: 0 };
  if (value >= xs[high]) return { i: high - 1, u: 1 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= value) low = middle; else high = middle;
  }
  return { i: low, u: (value - xs[low]) / (xs[high] - xs[low] || 1) };
}

const read = (column, place) => (column.length < 2 ? column[0] : mix(column[place.i], column[place.i + 1], place.u));

// Of values that may fall back: what the largest was so far.
function risen(values) {
  let most = -Infinity;
  return values.map((value) => (most = Math.max(most, value)));
}

function extent(values, least = 0) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const lack = Math.max(0, least - (high - low)) / 2;
  return [low - lack, high + lack];
}

// A step of 1, 2 or 5 times a power of ten, so that about `count` of them fit.
function tidyStep(span, count) {
  const raw = Math.max(span, 1e-9) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}

// matplotlib's plasma without its lightest end, as in the pictures: asphalt would swallow that.
const PLASMA = [[13, 8, 135], [92, 1, 166], [156, 23, 158], [204, 71, 120], [237, 121, 83], [253, 180, 47], [240, 249, 33]];
const PLASMA_END = 0.86;

function speedColour(share) {
  const at = clamp(share, 0, 1) * PLASMA_END * (PLASMA.length - 1);
  const i = Math.min(Math.floor(at), PLASMA.length - 2);
  return PLASMA[i].map((value, k) => Math.round(mix(value, PLASMA[i + 1][k], at - i)));
}

const css = (rgb) => `rgb(${rgb.join(",")})`;
const MARK = "#d55e00", HERE = "#0072b2";

// The colour of how far outside its lane a car is, or that of failing by the oracle; null up to a tenth of it.
function severeColour(scene, pose) {
  const { partly, mostly, colours, failed } = scene.severe;
  if (pose.failed > 0.5) return failed;
  return pose.outside > mostly ? colours[1] : pose.outside > partly ? colours[0] : null;
}

// Colours of what is drawn on paper, as the style sheet has them by day and by night.
const LOOK = {};

function takeLook() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "soft", "paper", "here", "halo", "case", "rule", "earth", "surface", "bend", "meadow", "grid", "map", "verge", "asphalt"]) {
    LOOK[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

takeLook();
