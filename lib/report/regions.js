/* Counts, filters, the table of regions, and the choice of one: the address says which (#region-12), so that each is a link. */

const MOST_ROWS = 500;
const table = { key: "urgency", descending: false };
const counts = countOutcomes(regions);

const kinds = [...new Set(regions.map((region) => region.kind))];
for (const [label, value] of [["everything", ""], ["all but blocks", "named"], ...kinds.map((kind) => [kind, kind])]) {
  element("kind").append(new Option(label, value));
}

function fillOutcomes() {
  const kind = element("kind").value;
  const among = regions.filter((region) => matchesFilters(region, { kind, outcome: "", search: "" }));
  const found = countOutcomes(among);
  const options = [["", "all", among.length], ["open", "not equivalent", among.length - found.EQUIVALENT], ...OUTCOMES.map((one) => [one, one, found[one]])];
  const before = element("outcome").value;
  element("outcome").replaceChildren(...options.map(([value, label, count]) => new Option(`${label} (${count})`, value)));
  element("outcome").value = before;
}

function addCell(row, content, className) {
  const td = row.insertCell();
  td.append(content);
  td.className = className;
}

function addRow(body, region) {
  const row = body.insertRow();
  const link = document.createElement("a");
  link.href = `#region-${region.index}`;
  link.textContent = region.name;
  row.dataset.region = region.index;
  addCell(row, region.kind, "");
  addCell(row, link, "name");
  addCell(row, region.outcome, region.outcome);
  addCell(row, formatBound(region.bound), "number");
  addCell(row, `${formatPercent(region.difference)} ${"RGB"[region.channel]}`, "number");
  addCell(row, `${formatPercent(region.low)} to ${formatPercent(region.high)}`, "number wide");
  addCell(row, formatNumber(region.reference), "number wide");
  addCell(row, formatNumber(region.candidate), "number wide");
  addCell(row, region.excluded_pixels ? `${region.pixels} (${region.excluded_pixels} excluded)` : `${region.pixels}`, "number wide");
  addCell(row, region.decided_at || "–", "number wide");
  row.addEventListener("pointerenter", () => { state.hovered = region; draw(); });
  row.addEventListener("pointerleave", () => { state.hovered = null; draw(); });
}

/* The regions that the filters let through, in the order of the table. */
function filtered() {
  const filters = { kind: element("kind").value, outcome: element("outcome").value, search: element("search").value };
  const rows = regions.filter((region) => matchesFilters(region, filters));
  return rows.sort((a, b) => (table.key === "urgency" ? compareUrgency(a, b) : compareRegions(a, b, table.key, table.descending)));
}

function fill() {
  fillOutcomes();
  const rows = filtered();
  const body = element("table").tBodies[0];
  body.replaceChildren();
  for (const region of rows.slice(0, MOST_ROWS)) addRow(body, region);
  const cut = rows.length > MOST_ROWS ? `, the first ${MOST_ROWS} shown` : "";
  element("shown").textContent = `${rows.length} of ${plural(regions.length, "region")}${cut}`;
  for (const th of document.querySelectorAll("th[data-key]")) {
    if (th.dataset.key === table.key) th.setAttribute("aria-sort", table.descending ? "descending" : "ascending");
    else th.removeAttribute("aria-sort");
  }
  markChosen();
}

function markChosen() {
  for (const row of element("table").tBodies[0].rows) {
    if (state.chosen.some((region) => region.index === Number(row.dataset.region))) row.setAttribute("aria-current", "true");
    else row.removeAttribute("aria-current");
  }
}

/* What the address asks for: one region, or all of an outcome. Both are outlined and shown as large as they can be. */
function follow() {
  const asked = readHash(location.hash, regions);
  if (!asked) return;
  if (asked.outcome !== null) {
    element("kind").value = "";
    element("search").value = "";
    fillOutcomes();
    element("outcome").value = asked.outcome;
    fill();
  }
  state.chosen = asked.chosen;
  element("chosen").textContent = asked.chosen.length === 1
    ? `Shown: ${asked.chosen[0].kind} ${asked.chosen[0].name}, ${asked.chosen[0].outcome}`
    : `Shown: ${plural(asked.chosen.length, "region")}, ${asked.outcome}`;
  markChosen();
  zoomTo(asked.chosen);
  element("images").scrollIntoView({ block: "start" });
}

/* The block at a pixel of the view is chosen without moving the picture. */
function chooseAt(x, y) {
  const block = findRegion(blocks, x * step, y * step);
  state.chosen = block && state.chosen[0] !== block ? [block] : [];
  element("chosen").textContent = state.chosen.length ? `Chosen: ${block.kind} ${block.name}, ${block.outcome}` : "";
  markChosen();
  draw();
}

/* The next region in the table, or the one before. */
function chooseNext(by) {
  const rows = filtered();
  if (!rows.length) return;
  const at = rows.findIndex((region) => region === state.chosen[0]);
  const next = at < 0 ? (by > 0 ? 0 : rows.length - 1) : (at + by + rows.length) % rows.length;
  location.hash = `#region-${rows[next].index}`;
}

for (const th of document.querySelectorAll("th[data-key]")) {
  th.firstElementChild.addEventListener("click", () => {
    table.descending = table.key === th.dataset.key ? !table.descending : th.classList.contains("number");
    table.key = th.dataset.key;
    fill();
  });
}
for (const id of ["kind", "outcome", "search"]) element(id).addEventListener("input", fill);
window.addEventListener("hashchange", follow);
// A link that was followed before zooms once more.
document.addEventListener("click", (event) => {
  const link = event.target.closest?.('a[href^="#region"]');
  if (link && link.hash === location.hash) follow();
});
