"use strict";
/* What the report computes: numbers, colours, regions. No function here touches the page, so a test runs them without a browser. */

/* The sRGB code value, 0 to 1, of linear light; negative light gives 0. IEC 61966-2-1, as in lib/srgb.py. */
function encodeSrgb(linear) {
  const light = Math.max(linear, 0);
  return light < 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055;
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

/* Whether a region passes the filters: `kind` is "", "named" (all but blocks) or a kind, `outcome` is "" or one, `search` a part of a name. */
function matchesFilters(region, { kind, outcome, search }) {
  return (kind === "" || (kind === "named" ? region.kind !== "block" : region.kind === kind)) &&
    (outcome === "" || region.outcome === outcome) &&
    region.name.toLowerCase().includes(search.toLowerCase());
}

/* The order of two regions by a key; what is not known is smallest, and numbers within names count as numbers. */
function compareRegions(a, b, key, descending) {
  const [x, y] = [a[key] ?? -Infinity, b[key] ?? -Infinity];
  const order = typeof x === "string" ? x.localeCompare(y, undefined, { numeric: true }) : x === y ? 0 : x - y;
  return descending ? -order : order;
}

/* The corner and size [x, y, width, height] on a view averaged over step x step pixels of a box of pixels, both of whose ends count. */
function placeBox([x0, y0, x1, y1], step) {
  return [x0 / step, y0 / step, (x1 + 1 - x0) / step, (y1 + 1 - y0) / step];
}

/* The first region whose box holds pixel (x, y); undefined where none does. */
function findRegion(regions, x, y) {
  return regions.find(({ box }) => x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3]);
}
