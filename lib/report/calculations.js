"use strict";
/* What the report computes: numbers, colours, regions. No function here touches the page, so a test runs them without a browser. */

/* The sRGB code value, 0 to 1, of linear light; negative light gives 0. IEC 61966-2-1, as in lib/srgb.py. */
function encodeSrgb(linear) {
  const light = Math.max(linear, 0);
  return light < 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055;
}

/* The luminance of linear Rec. 709 light (ITU-R BT.709). */
function luminance(red, green, blue) {
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/* gap / max(|reference|, floor); 0 where gap is 0. As in lib/relative.py. */
function relativeDifference(gap, reference, floor) {
  return gap === 0 ? 0 : gap / Math.max(Math.abs(reference), floor);
}

function formatPercent(value) {
  if (value === null || !Number.isFinite(value)) return "unbounded";
  return (value < 0 ? "−" : "+") + Math.abs(100 * value).toPrecision(3) + " %";
}

/* A bound as a percentage that is not below it, of two significant digits. As format_bound in lib/pages/formats.py. */
function formatBound(bound) {
  if (bound === null || !Number.isFinite(bound)) return "unbounded";
  if (bound === 0) return "0 %";
  const step = 10 ** (Math.floor(Math.log10(bound)) - 1);
  return Number((100 * step * Math.ceil((bound / step) * (1 - 1e-9))).toPrecision(6)) + " %";
}

/* The colour of a bound on the map: green up to the tolerance, from yellow to red at BOUND_ENDS tolerances, grey without one. */
const BOUND_COLORS = [[27, 127, 92], [240, 228, 120], [200, 62, 36]];
const BOUND_ENDS = 30;
function colorBound(bound, tolerance) {
  if (bound === null || !Number.isFinite(bound)) return [128, 128, 128];
  if (bound <= tolerance) return BOUND_COLORS[0];
  const part = Math.min(Math.log(bound / tolerance) / Math.log(BOUND_ENDS), 1);
  return BOUND_COLORS[1].map((from, c) => Math.round(from + (BOUND_COLORS[2][c] - from) * part));
}

/* Matplotlib's magma at every eighth of its way. */
const MAGMA = [[0, 0, 4], [28, 16, 68], [79, 18, 123], [129, 37, 129], [181, 54, 122], [229, 80, 100], [251, 135, 97], [254, 194, 135], [252, 253, 191]];

/* Magma's colour at `part`, 0 to 1; values beyond the ends get the ends' colours. */
function colorMagma(part) {
  const place = Math.min(Math.max(part, 0), 1) * (MAGMA.length - 1);
  const low = Math.min(Math.floor(place), MAGMA.length - 2);
  return MAGMA[low].map((from, c) => from + (MAGMA[low + 1][c] - from) * (place - low));
}

/* Blue at -1, white at 0, red at 1: ColorBrewer's RdBu, as signed8 in lib/film/pictures.py. */
function colorSigned(part) {
  const end = part < 0 ? [33, 102, 172] : [178, 24, 43];
  return end.map((to) => 247 + (to - 247) * Math.min(Math.abs(part), 1));
}

/* The place, 0 to 1, on the scale of false colours: from FALSE_STOPS stops below white at 0 to white at 1. Black and negative light are at 0. */
const FALSE_STOPS = 10;
function placeFalseColor(light) {
  return light > 0 ? Math.min(Math.max(1 + Math.log2(light) / FALSE_STOPS, 0), 1) : 0;
}

/* The shares of `values` in `bins` equal bins from low to high; what lies beyond is counted in the bins at the ends, NaN is not. */
function histogram(values, low, high, bins) {
  const shares = new Array(bins).fill(0);
  let total = 0;
  for (const value of values) {
    if (Number.isNaN(value)) continue;
    shares[Math.min(Math.max(Math.floor((bins * (value - low)) / (high - low)), 0), bins - 1)] += 1;
    total += 1;
  }
  return shares.map((count) => (total ? count / total : 0));
}

function formatNumber(value) {
  if (value === null || !Number.isFinite(value)) return "none";
  return Math.abs(value) >= 1e5 ? value.toExponential(3) : value.toPrecision(4);
}

/* The channel of the largest difference; those that are not known count as zero. */
function worstChannel(difference) {
  let worst = 0;
  for (let c = 1; c < 3; c++) if (Math.abs(difference[c]) > Math.abs(difference[worst])) worst = c;
  return worst;
}

/* A region as the table shows it: its figures in the channel furthest off, and `size` to sort by, -1 where no difference is known. */
function pickChannel(region) {
  const channel = worstChannel(region.difference);
  const picked = { ...region, channel };
  for (const key of ["reference", "candidate", "difference", "low", "high"]) picked[key] = region[key][channel];
  picked.size = picked.difference === null ? -1 : Math.abs(picked.difference);
  return picked;
}

/* Whether a region passes the filters: `kind` is "", "named" (neither blocks nor cells) or a kind; `outcome` is "", "open" (all but
   EQUIVALENT) or one; `search` is a part of a name. */
const GRIDS = ["block", "cell"];
function matchesFilters(region, { kind, outcome, search }) {
  return (kind === "" || (kind === "named" ? !GRIDS.includes(region.kind) : region.kind === kind)) &&
    (outcome === "" || (outcome === "open" ? region.outcome !== "EQUIVALENT" : region.outcome === outcome)) &&
    region.name.toLowerCase().includes(search.toLowerCase());
}

/* The order of two regions by a key; what is not known is smallest, and numbers within names count as numbers. */
function compareRegions(a, b, key, descending) {
  const [x, y] = [a[key] ?? -Infinity, b[key] ?? -Infinity];
  const order = typeof x === "string" ? x.localeCompare(y, undefined, { numeric: true }) : x === y ? 0 : x - y;
  return descending ? -order : order;
}

/* How far a region may be off: the bound of one that is undecided, the difference of others. */
function extentOf(region) {
  if (region.outcome !== "UNDECIDED") return region.size;
  return region.bound ?? (region.pixels > region.excluded_pixels ? Infinity : -1);
}

/* The order in which the report opens: what is not equivalent first, named regions before blocks, then what is or may be furthest off.
   As order_regions in report/page.py. */
const OUTCOMES = ["DIFFERENT", "UNDECIDED", "EXPLAINED", "EQUIVALENT"];
function compareUrgency(a, b) {
  return OUTCOMES.indexOf(a.outcome) - OUTCOMES.indexOf(b.outcome) ||
    GRIDS.includes(a.kind) - GRIDS.includes(b.kind) || (extentOf(a) === extentOf(b) ? 0 : extentOf(b) - extentOf(a)) || a.index - b.index;
}

/* A count with its noun, as plural of lib/plural.py. */
function plural(count, noun) {
  return `${count.toLocaleString("en-US")} ${noun}${count === 1 ? "" : "s"}`;
}

/* The number of regions of each outcome. */
function countOutcomes(regions) {
  const counts = Object.fromEntries(OUTCOMES.map((outcome) => [outcome, 0]));
  for (const { outcome } of regions) counts[outcome] += 1;
  return counts;
}

/* What an address ends in: #region-12 is a region by its place in the list, #regions-UNDECIDED all of an outcome; null for anything else. */
function readHash(hash, regions) {
  const one = /^#region-(\d+)$/.exec(hash);
  if (one && Number(one[1]) < regions.length) return { chosen: [regions[Number(one[1])]], outcome: null };
  const many = /^#regions-([A-Z]+)$/.exec(hash);
  if (!many || !OUTCOMES.includes(many[1])) return null;
  return { chosen: regions.filter((region) => region.outcome === many[1]), outcome: many[1] };
}

/* The corner and size [x, y, width, height] on a view averaged over step x step pixels of a box of pixels, both of whose ends count. */
function placeBox([x0, y0, x1, y1], step) {
  return [x0 / step, y0 / step, (x1 + 1 - x0) / step, (y1 + 1 - y0) / step];
}

/* The box around the boxes of regions, of which there must be one. */
function joinBoxes(regions) {
  const edge = (i, choose) => regions.reduce((found, { box }) => choose(found, box[i]), regions[0].box[i]);
  return [edge(0, Math.min), edge(1, Math.min), edge(2, Math.max), edge(3, Math.max)];
}

/* Scale and offset that show [x, y, width, height] in the middle of a pane, at 6 tenths of its size, and no closer than MOST_ZOOM times. */
const MOST_ZOOM = 40;
function frame([x, y, width, height], paneWidth, paneHeight) {
  const scale = Math.min((0.6 * paneWidth) / width, (0.6 * paneHeight) / height, MOST_ZOOM);
  return { scale, x: paneWidth / 2 - scale * (x + width / 2), y: paneHeight / 2 - scale * (y + height / 2) };
}

/* The edges [x0, y0, x1, y1] between pixels of a map (row-major, `width` across) that hold `value` and pixels that do not. */
function outline(labels, width, value) {
  const edges = [];
  const height = labels.length / width;
  const holds = (x, y) => x >= 0 && y >= 0 && x < width && y < height && labels[y * width + x] === value;
  for (let y = 0; y <= height; y++) {
    for (let x = 0; x <= width; x++) {
      if (holds(x, y) !== holds(x, y - 1)) edges.push([x, y, x + 1, y]);
      if (holds(x, y) !== holds(x - 1, y)) edges.push([x, y, x, y + 1]);
    }
  }
  return edges;
}

/* The first region whose box holds pixel (x, y); undefined where none does. */
function findRegion(regions, x, y) {
  return regions.find(({ box }) => x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3]);
}
