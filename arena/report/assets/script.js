"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
// Okabe and Ito's colours; the dashes differ, too.
const COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#888888"];
const DASHES = [[], [7, 3], [7, 3, 2, 3], [2, 3], [11, 3], [4, 2, 1, 2], [1, 2]];
const ACTIONS = [["thrust left", "#0072B2"], ["no thrust", "var"], ["thrust right", "#E69F00"]];
const UNVISITED = "#999999";
const redraws = [];

/** A canvas as sharp as the screen: its context, width and height in CSS pixels, wiped. */
function wiped(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, most = Number(canvas.dataset.height);
  const height = canvas.className === "square" ? Math.min(most, width) : most;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  canvas.style.height = height + "px";
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.clearRect(0, 0, width, height);
  pen.font = "13px system-ui, sans-serif";
  pen.fillStyle = pen.strokeStyle = css("--ink");
  return [pen, width, height];
}

/** Round numbers between two, about six. */
function ticks(low, high) {
  const rough = (high - low || 1) / 7, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((one) => one * power >= rough) * power;
  const first = Math.ceil(low / step), last = Math.floor(high / step);
  return Array.from({length: last - first + 1}, (_, k) => (first + k) * step);
}

/** A label along the left edge, upward. */
function upward(pen, text, y) {
  pen.save();
  pen.translate(14, y);
  pen.rotate(-Math.PI / 2);
  pen.textAlign = "center";
  pen.fillText(text, 0, 0);
  pen.restore();
}

function element(name, text, parent) {
  const made = document.createElement(name);
  made.textContent = text;
  parent.append(made);
  return made;
}

function fill(select, names, chosen) {
  for (const [value, name] of names) {
    const option = element("option", name, select);
    option.value = value;
    option.selected = chosen.includes(value);
  }
}

function legend(list, rows) {
  list.replaceChildren();
  for (const [color, text] of rows) {
    const item = element("li", "", list);
    const swatch = element("span", "", item);
    swatch.className = "swatch";
    swatch.style.background = color;
    item.append(text);
  }
}

const chosen = (select) => Array.from(select.selectedOptions, (option) => Number(option.value));
const drawn = data.drawn.map((one, number) => [number, data.names[one.entrant]]);
const first = (count, has) => drawn.filter(([number]) => has(data.drawn[number])).slice(0, count);
const number = (value) => value.toLocaleString("en");

// The leaderboard.
function sortable(table) {
  const body = table.tBodies[0], heads = Array.from(table.tHead.rows[0].cells);
  const value = (row, column) => {
    const cell = row.cells[column];
    return cell.dataset.value === undefined ? cell.textContent : Number(cell.dataset.value);
  };
  heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => {
    const up = head.getAttribute("aria-sort") !== "ascending";
    heads.forEach((other) => other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
    const rows = Array.from(body.rows).map((row) => [value(row, column), row]);
    rows.sort(([a], [b]) => (up ? 1 : -1) * (typeof a === "string" ? a.localeCompare(b) : (a - b)));
    body.append(...rows.map(([, row]) => row));
  }));
}

function showTies(entrant) {
  const rows = Array.from($("board").tBodies[0].rows);
  const tied = data.names.filter((_, other) => other !== entrant && data.apart[entrant][other] === "0");
  for (const row of rows) {
    const other = Number(row.dataset.entrant);
    row.classList.toggle("chosen", other === entrant);
    row.classList.toggle("tied", other !== entrant && data.apart[entrant][other] === "0");
  }
  $("ties").textContent = tied.length
    ? `${data.names[entrant]} cannot be told apart from: ${tied.join(", ")}.`
    : `${data.names[entrant]} can be told apart from all others.`;
}

function leaderboard() {
  sortable($("board"));
  $("board").tBodies[0].addEventListener("click", (event) => {
    if (event.target.matches("button")) showTies(Number(event.target.closest("tr").dataset.entrant));
  });
  $("filter").addEventListener("input", () => {
    const asked = $("filter").value.toLowerCase();
    for (const row of $("board").tBodies[0].rows) row.hidden = !row.textContent.toLowerCase().includes(asked);
  });
}

// Learning curves.
function curves() {
  const shown = chosen($("learners")).filter((one) => data.drawn[one].curve).slice(0, COLORS.length);
  const [pen, width, height] = wiped($("curves")), left = 70, bottom = height - 45, right = width - 10, top = 12;
  const all = shown.map((one) => data.drawn[one].curve);
  const low = Math.min(...all.flatMap((curve) => curve.low)), high = Math.max(...all.flatMap((curve) => curve.high));
  const last = data.episodes;
  const x = (episode) => left + (right - left) * episode / last;
  const y = (reward) => bottom - (bottom - top) * (reward - low) / (high - low || 1);
  legend($("curves-legend"), shown.map((one, k) => [COLORS[k], data.names[data.drawn[one].entrant]]));
  $("curves").setAttribute("aria-label", "Learning curves. " + shown.map((one) => {
    const curve = data.drawn[one].curve;
    return `${data.names[data.drawn[one].entrant]}: from ${curve.mean[0]} to ${curve.mean.at(-1)}`;
  }).join("; "));
  if (!shown.length) return;
  pen.textAlign = "right";
  for (const reward of ticks(low, high)) {
    pen.fillText(number(reward), left - 8, y(reward) + 4);
    pen.fillRect(left, Math.round(y(reward)), right - left, .25);
  }
  for (const episode of ticks(0, last)) pen.fillText(number(episode), Math.max(x(episode), left + 8), bottom + 18);
  pen.textAlign = "center";
  pen.fillText("episode of training", (left + right) / 2, height - 6);
  upward(pen, "accumulated reward", (top + bottom) / 2);
  all.forEach((curve, k) => {
    pen.fillStyle = pen.strokeStyle = COLORS[k];
    pen.globalAlpha = .2;
    pen.beginPath();
    data.at.forEach((episode, i) => pen.lineTo(x(episode), y(curve.low[i])));
    data.at.toReversed().forEach((episode, i) => pen.lineTo(x(episode), y(curve.high.at(-1 - i))));
    pen.fill();
    pen.globalAlpha = 1;
    pen.lineWidth = 2;
    pen.setLineDash(DASHES[k]);
    pen.beginPath();
    data.at.forEach((episode, i) => pen.lineTo(x(episode), y(curve.mean[i])));
    pen.stroke();
  });
}

// Policies and visits.
const shade = (share) => {  // cividis, by five of its colours
  const stops = [[0, 34, 78], [60, 77, 110], [124, 123, 120], [187, 175, 113], [254, 232, 56]];
  const place = Math.min(3.999, share * 4), k = Math.floor(place);
  return "rgb(" + stops[k].map((a, d) => Math.round(a + (stops[k + 1][d] - a) * (place - k))).join() + ")";
};

function total(map, cell, layer) {
  const counts = map.visits.slice(3 * cell, 3 * cell + 3);
  return layer === 3 ? counts[0] + counts[1] + counts[2] : counts[layer];
}

function maps() {
  const one = data.drawn[chosen($("mapped"))[0]];
  const [pen, width, height] = wiped($("map")), left = 76, bottom = height - 45, right = width - 10, top = 8;
  if (!one) return;
  const {x: xs, v: vs, policy, visits} = one.map, rows = vs.length - 1, cells = (xs.length - 1) * rows;
  const layer = $("layer").value === "policy" ? -1 : Number($("layer").value);
  const name = data.names[one.entrant];
  const x = (a) => left + (right - left) * (a - xs[0]) / (xs.at(-1) - xs[0]);
  const y = (a) => bottom - (bottom - top) * (a - vs[0]) / (vs.at(-1) - vs[0]);
  $("map-told").textContent = "";
  if (layer >= 0 ? !visits : !policy) {
    const why = layer >= 0 ? "counts no visits of the cells of a grid" : "drives by chance: it has no policy";
    $("map-told").textContent = `${name} ${why}.`;
    legend($("map-legend"), []);
    return;
  }
  const counts = visits ? Array.from({length: cells}, (_, cell) => total(one.map, cell, layer < 0 ? 3 : layer)) : [];
  const most = layer < 0 ? 0 : Math.max(10, ...Array.from({length: cells}, (_, cell) => total(one.map, cell, 3)));
  let never = 0;
  for (let cell = 0; cell < cells; cell++) {
    const i = Math.floor(cell / rows), j = cell % rows, action = policy ? Number(policy[cell]) : 0;
    const unseen = visits && counts[cell] === 0;
    const color = action === 1 ? css("--none") : ACTIONS[action][1];
    never += unseen ? 1 : 0;
    pen.fillStyle = unseen ? UNVISITED : layer < 0 ? color : shade(Math.log(counts[cell]) / Math.log(most));
    pen.fillRect(x(xs[i]), y(vs[j + 1]), x(xs[i + 1]) - x(xs[i]) + .5, y(vs[j]) - y(vs[j + 1]) + .5);
    if (unseen) {
      pen.strokeStyle = "#444444";
      pen.beginPath();
      pen.moveTo(x(xs[i]), y(vs[j]));
      pen.lineTo(x(xs[i + 1]), y(vs[j + 1]));
      pen.stroke();
    }
  }
  pen.fillStyle = css("--ink");
  for (let k = 0; k <= 4; k++) {
    const a = xs[0] + (xs.at(-1) - xs[0]) * k / 4, b = vs[0] + (vs.at(-1) - vs[0]) * k / 4;
    pen.textAlign = k === 4 ? "right" : "center";
    pen.fillText(a.toFixed(2), x(a), bottom + 18);
    pen.textAlign = "right";
    pen.fillText(b.toFixed(3), left - 6, y(b) + (k === 4 ? 10 : 4));
  }
  pen.textAlign = "center";
  pen.fillText("position (units of length)", (left + right) / 2, height - 6);
  upward(pen, "velocity (length / time)", (top + bottom) / 2);
  const key = layer < 0 ? ACTIONS.map(([text, color]) => [color === "var" ? css("--none") : color, text])
    : [[shade(0), "1"], [shade(.5), number(Math.round(Math.sqrt(most)))], [shade(1), `${number(most)} times (logarithmic)`]];
  if (never) key.push([UNVISITED, `never (${never} cells)`]);
  legend($("map-legend"), key);
  $("map").setAttribute("aria-label", `${name}: ${$("layer").selectedOptions[0].textContent}, ${cells} cells, ${never} never visited`);
}

// The matrix of pairs.
function pairs() {
  const count = data.names.length, [pen, width, height] = wiped($("matrix")), size = Math.min(width, height) / count;
  const a = Number($("row").value), b = Number($("column").value), ink = css("--ink");
  const mix = (share) => {  // orange, white, purple
    const end = share < 50 ? [179, 88, 6] : [84, 39, 136], far = Math.abs(share - 50) / 50;
    return "rgb(" + end.map((part) => Math.round(247 + (part - 247) * far)).join() + ")";
  };
  data.better.forEach((row, i) => row.forEach((share, j) => {
    pen.fillStyle = mix(share);
    pen.fillRect(j * size, i * size, size + .5, size + .5);
    if (size > 7 && data.apart[i][j] === "1") {
      pen.fillStyle = Math.abs(share - 50) > 25 ? "#ffffff" : "#000000";
      pen.fillRect((j + .5) * size - 1.5, (i + .5) * size - 1.5, 3, 3);
    }
  }));
  pen.strokeStyle = ink;
  pen.lineWidth = 2;
  pen.strokeRect(b * size, a * size, size, size);
  const apart = data.apart[a][b] === "1" ? "They can be told apart." : a === b ? "" : "They cannot be told apart.";
  $("pair-told").textContent = `A run of ${data.names[a]} is better than one of ${data.names[b]}: ${data.better[a][b]}%. ${apart}`;
}

// The race.
const race = {step: 0, going: null, last: 0};
const driven = (one, start) => data.drawn[one].drives[start];

function track() {
  const start = Number($("start").value), cars = chosen($("cars")).slice(0, COLORS.length);
  const [pen, width, height] = wiped($("track")), hill = data.hill, top = 40, bottom = height - 25;
  const lanes = cars.map((one, k) => [data.names[data.drawn[one].entrant], driven(one, start), COLORS[k]]);
  const ghost = data.ghost && data.ghost[start];
  const longest = Math.max(1, ...lanes.map(([, drive]) => drive.length - 1), ghost ? ghost.length - 1 : 1);
  $("scrubber").max = longest;
  race.step = Math.min(race.step, longest);
  $("scrubber").value = race.step;
  const heights = Array.from({length: 201}, (_, k) => Math.sin(hill.omega * (hill.low + (hill.high - hill.low) * k / 200)));
  const low = Math.min(...heights), high = Math.max(...heights);
  const x = (position) => width * (position - hill.low) / (hill.high - hill.low);
  const y = (position) => bottom - (bottom - top) * (Math.sin(hill.omega * position) - low) / (high - low);
  pen.beginPath();
  pen.moveTo(0, height);
  heights.forEach((_, k) => { const p = hill.low + (hill.high - hill.low) * k / 200; pen.lineTo(x(p), y(p)); });
  pen.lineTo(width, height);
  pen.fillStyle = css("--ground");
  pen.fill();
  pen.fillStyle = pen.strokeStyle = css("--ink");
  pen.fillRect(x(hill.goal), y(hill.goal) - 36, 2, 36);
  pen.fillText("goal", x(hill.goal) - 32, y(hill.goal) - 26);
  const car = (drive, color, solid) => {
    const p = drive[Math.min(race.step, drive.length - 1)] / 1000, slope = hill.omega * Math.cos(hill.omega * p);
    pen.save();
    pen.translate(x(p), y(p));
    pen.rotate(-Math.atan(slope * ((bottom - top) / (high - low)) / (width / (hill.high - hill.low))));
    pen.beginPath();
    pen.rect(-14, -15, 28, 9);
    pen.rect(-8, -21, 15, 6);
    pen.globalAlpha = solid ? 1 : .35;
    pen.fillStyle = color;
    pen.fill();
    pen.globalAlpha = 1;
    pen.strokeStyle = css("--ink");
    pen.setLineDash(solid ? [] : [3, 2]);
    pen.stroke();
    pen.fillStyle = css("--ink");
    for (const wheel of [-8, 8]) { pen.beginPath(); pen.arc(wheel, -4, 4, 0, 7); pen.fill(); }
    pen.restore();
  };
  if (ghost) car(ghost, css("--none"), false);
  lanes.toReversed().forEach(([, drive, color]) => car(drive, color, true));
  $("race-step").textContent = `Step ${race.step} of ${longest}`;
  const told = (name, drive) => {
    const steps = drive.length - 1, there = drive.at(-1) / 1000 >= hill.goal;
    return race.step < steps ? `${name}: under way` : there ? `${name}: goal in ${steps} steps` : `${name}: not at the goal in ${steps} steps`;
  };
  const rows = lanes.map(([name, drive, color]) => [color, told(name, drive)]);
  legend($("race-told"), ghost ? [...rows, [css("--none"), told("optimal drive", ghost)]] : rows);
  return longest;
}

function stop() {
  cancelAnimationFrame(race.going);
  race.going = null;
  $("play").textContent = "Play";
}

function play() {
  const longest = track();
  race.step = race.step >= longest ? 0 : race.step;
  race.last = performance.now();
  $("play").textContent = "Pause";
  const frame = (now) => {
    const steps = Math.floor((now - race.last) * Number($("speed").value) / 1000);
    if (steps > 0) {
      race.last = now;
      race.step += steps;
      if (race.step >= track()) return stop();
    }
    race.going = requestAnimationFrame(frame);
  };
  race.going = requestAnimationFrame(frame);
}

function begin() {
  for (const canvas of document.querySelectorAll("canvas")) canvas.dataset.height = canvas.getAttribute("height");
  leaderboard();
  fill($("learners"), drawn.filter(([one]) => data.drawn[one].curve), first(5, (one) => one.curve).map(([one]) => one));
  fill($("mapped"), drawn.filter(([one]) => data.drawn[one].map), [first(1, (one) => one.map && one.map.visits)[0]?.[0]]);
  fill($("cars"), drawn.filter(([one]) => data.drawn[one].drives), first(3, (one) => one.drives).map(([one]) => one));
  fill($("start"), data.starts.map((start, k) => [k, start.toFixed(2)]), [Math.floor(data.starts.length / 2)]);
  for (const [select, at] of [[$("row"), 0], [$("column"), Math.min(1, data.names.length - 1)]])
    fill(select, data.names.map((name, k) => [k, name]), [at]);
  const wired = [[curves, ["learners"]], [maps, ["mapped", "layer"]], [pairs, ["row", "column"]], [track, ["cars", "start"]]];
  for (const [draw, ids] of wired) {
    redraws.push(draw);
    for (const id of ids) $(id).addEventListener("change", draw);
  }
  $("matrix").addEventListener("click", (event) => {
    const box = $("matrix").getBoundingClientRect(), size = Math.min(box.width, box.height) / data.names.length;
    const at = (distance) => Math.min(data.names.length - 1, Math.floor(distance / size));
    if (Math.max(event.clientX - box.left, event.clientY - box.top) > size * data.names.length) return;
    $("row").value = at(event.clientY - box.top);
    $("column").value = at(event.clientX - box.left);
    pairs();
  });
  $("play").addEventListener("click", () => (race.going === null ? play() : stop()));
  $("scrubber").addEventListener("input", () => { stop(); race.step = Number($("scrubber").value); track(); });
  const redraw = () => redraws.forEach((draw) => draw());
  redraw();
  window.addEventListener("resize", redraw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}
begin();
