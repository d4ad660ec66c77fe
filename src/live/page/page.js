// The page: waits for news, shows them, and passes on what is wished for.

import * as controls from "/controls.js";
import * as pixel from "/pixel.js";

const by = (id) => document.getElementById(id);
const canvas = by("picture");
const small = document.createElement("canvas");
const known = { status: null, picture: null, controls: null, verify: null };
let whole = [640, 480];
let group = null;

// ---- news

async function follow() {
  let after = 0;
  for (;;) {
    try {
      const answer = await fetch(`/next?after=${after}`);
      if (!answer.ok) throw new Error(answer.statusText);
      const bytes = await answer.arrayBuffer();
      const length = new DataView(bytes).getUint32(0, true);
      const { version, news } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
      // Numbers that fall are those of another run.
      if (version < after) { after = 0; continue; }
      after = version;
      by("lost").hidden = true;
      take(news, bytes.byteLength > 4 + length ? new Uint8ClampedArray(bytes, 4 + length) : null);
    } catch {
      by("lost").hidden = false;
      state("lost");
      after = 0;
      await new Promise((done) => setTimeout(done, 700));
    }
  }
}

function take(news, bytes) {
  Object.assign(known, news);
  if (news.picture && bytes) paint(news.picture, bytes);
  if (news.controls) drawControls();
  if (news.status) drawStatus();
  if (news.picture || news.status) drawFigures();
  if (news.verify) drawVerify();
  if (news.screen && document.activeElement !== by("exposure")) showScreen(news.screen);
  if ((news.picture && !news.picture.coarse && looked !== news.picture.change) || news.status?.state === "wrong") lookAgain();
}

function state(name) {
  by("state").dataset.state = name;
  by("state").textContent = { wrong: "error", lost: "lost" }[name] ?? name;
}

function drawStatus() {
  const status = known.status;
  state(status.state);
  by("file").textContent = status.file;
  document.title = `${status.state === "wrong" ? "✗ " : ""}${status.file.split("/").pop()} · velour`;
  by("trouble").hidden = !status.trouble;
  by("trouble").textContent = status.trouble ?? "";
  by("stale").hidden = !(status.trouble && known.picture);
  by("said").textContent = status.notes.join("\n") || "Nothing to say.";
  by("count").textContent = status.notes.length || "";
  by("reset").disabled = status.set === 0;
  fit();
}

function drawFigures() {
  const picture = known.picture;
  if (!picture) return;
  const [least, most] = picture.samples;
  const entry = (name, value) => {
    const span = document.createElement("span");
    const bold = document.createElement("b");
    bold.textContent = value;
    span.append(`${name} `, bold);
    return span;
  };
  const error = picture.error === null ? "…" : picture.error.toExponential(1);
  const all = [
    entry("", picture.whole.join(" × ")),
    entry("samples", least === most ? most : `${least} to ${most}`),
    entry("error", picture.goal ? `${error} of ${Number(picture.goal.toPrecision(2))}` : error),
  ];
  if (picture.waited !== null) all.push(entry("first picture", `${Math.round(picture.waited)} ms`));
  by("figures").replaceChildren(...all);
}

// ---- the picture

function paint(picture, bytes) {
  const data = new ImageData(bytes, picture.width, picture.height);
  const [width, height] = picture.whole;
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height] = [width, height];
    whole = [width, height];
    fit();
  }
  const context = canvas.getContext("2d");
  if (picture.width === width && picture.height === height) {
    context.putImageData(data, 0, 0);
  } else {
    [small.width, small.height] = [picture.width, picture.height];
    small.getContext("2d").putImageData(data, 0, 0);
    context.imageSmoothingQuality = "high";
    context.drawImage(small, 0, 0, width, height);
  }
  canvas.dataset.change = picture.change;
  canvas.dataset.samples = picture.samples[0];
}

// As large as there is room, in the middle.
function fit() {
  const stage = by("stage");
  const scale = Math.min(stage.clientWidth / whole[0], stage.clientHeight / whole[1]);
  const [width, height] = whole.map((side) => side * scale);
  const [left, top] = [(stage.clientWidth - width) / 2, (stage.clientHeight - height) / 2];
  Object.assign(canvas.style, { width: `${width}px`, height: `${height}px`, left: `${left}px`, top: `${top}px` });
  canvas.style.imageRendering = scale >= 3 ? "pixelated" : "auto";
  if (kept) placeMark();
}
new ResizeObserver(fit).observe(by("stage"));

// ---- a pixel

let wanted = null;
let asking = false;
let kept = null;
let looked = -1;

function pixelAt(event) {
  const box = canvas.getBoundingClientRect();
  const at = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  if (at.some((x) => x < 0 || x >= 1)) return null;
  return at.map((x, k) => Math.floor(x * whole[k]));
}

async function look(at) {
  wanted = at;
  if (asking) return;
  asking = true;
  while (wanted) {
    const [x, y] = wanted;
    wanted = null;
    try {
      const answer = await fetch(`/pixel?x=${x}&y=${y}`);
      if (answer.ok) drawLook(await answer.json());
    } catch { /* the page says that velour is gone */ }
  }
  asking = false;
}

let last = null;
function lookAgain() {
  looked = known.picture?.change ?? -1;
  if (last) look(last);
}

function drawLook(found) {
  if (!found.total) {
    by("where").textContent = found.nothing ? `${found.x}, ${found.y}: nothing` : found.trouble ? "no pixels while something is wrong" : "";
    return;
  }
  const place = `u ${found.uv[0].toFixed(3)}, v ${found.uv[1].toFixed(3)}`;
  by("where").textContent = [`${found.x}, ${found.y}`, found.name, place, kept && "kept, Esc lets go"].filter(Boolean).join(" · ");
  pixel.draw(found);
  shown = found;
  if (kept && found.group !== null && kept.fresh) {
    kept.fresh = false;
    choose(found.group);
  }
}
let shown = null;
new ResizeObserver(() => shown && pixel.draw(shown)).observe(by("plot"));

function placeMark() {
  const mark = by("mark");
  mark.hidden = false;
  const box = [parseFloat(canvas.style.width), parseFloat(canvas.style.height)];
  const at = kept.at.map((x, k) => ((x + 0.5) / whole[k]) * box[k]);
  mark.style.left = `${parseFloat(canvas.style.left) + at[0]}px`;
  mark.style.top = `${parseFloat(canvas.style.top) + at[1]}px`;
}

by("stage").addEventListener("pointermove", (event) => {
  const at = pixelAt(event);
  if (!at || kept) return;
  last = at;
  look(at);
});
by("stage").addEventListener("click", (event) => {
  const at = pixelAt(event);
  if (!at) return;
  kept = { at, fresh: true };
  last = at;
  placeMark();
  show("pixel");
  look(at);
});
addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  kept = null;
  by("mark").hidden = true;
});

// ---- parameters

function drawControls() {
  const { groups, first } = known.controls;
  const menu = by("group");
  if (group === null || group >= groups.length) group = first;
  group = groups[group].as ?? group;
  const option = (entry, k) => (entry.as === null ? [Object.assign(document.createElement("option"), { value: k, textContent: entry.name })] : []);
  menu.replaceChildren(...groups.flatMap(option));
  menu.value = group;
  if (groups[group]) controls.draw(by("controls"), groups[group], group);
  const text = controls.written(groups);
  by("values").hidden = !text;
  by("written").textContent = text;
  by("reset").disabled = !text;
}

function choose(number) {
  group = Number(number);
  drawControls();
}
by("group").onchange = (event) => choose(event.target.value);
by("reset").onclick = () => controls.send("/reset", {});
by("copy").onclick = () => navigator.clipboard?.writeText(by("written").textContent);

function showStops(stops) {
  by("exposure").value = stops;
  by("stops").textContent = `${stops > 0 ? "+" : ""}${Number(stops).toFixed(1)} EV`;
}
function showScreen(screen) {
  showStops(screen.stops);
  by("screen").value = screen.view;
}
function sendScreen() {
  showStops(by("exposure").value);
  controls.send("/screen", { stops: Number(by("exposure").value), view: by("screen").value });
}
by("exposure").oninput = sendScreen;
by("exposure").ondblclick = () => { by("exposure").value = 0; sendScreen(); };
by("screen").onchange = sendScreen;

// ---- verify

by("run").onclick = () => controls.send("/verify", { group: group ?? 0 });

function drawVerify() {
  const verify = known.verify;
  const running = verify.state === "running";
  by("run").disabled = running;
  const verdict = by("verdict");
  verdict.className = "verdict";
  if (running) {
    verdict.textContent = verify.total ? `${verify.shader}: ${verify.done} of ${verify.total} variants` : `${verify.shader}: looking for places`;
    return;
  }
  if (verify.state === "error") {
    verdict.textContent = verify.text;
    verdict.classList.add("FAIL");
    by("findings").replaceChildren();
    return;
  }
  const given = verify.given.length ? ` with ${verify.given.join(", ")}` : "";
  verdict.textContent = `${verify.shader}${given}: ${verify.passed ? "nothing fails" : "something FAILS"}${verify.alone ? " (this layer alone)" : ""}${verify.stale ? ", in the text before the mistake" : ""}`;
  verdict.classList.add(verify.passed ? "pass" : "FAIL");
  pixel.table(
    by("findings"),
    verify.rows.map((found) => (row) => {
      pixel.cell(row, found.check);
      pixel.cell(row, found.worst, "number");
      pixel.cell(row, found.bound);
      pixel.cell(row, found.verdict, found.verdict);
      pixel.cell(row, found.place, "wide");
    }),
    [["check"], ["worst", "number"], ["bound"], ["verdict"], ["where"]],
  );
}

// ---- panels

function show(name) {
  for (const panel of ["pixel", "verify", "notes"]) {
    by(panel).hidden = panel !== name;
    by(`tab-${panel}`).setAttribute("aria-selected", panel === name);
  }
}
for (const panel of ["pixel", "verify", "notes"]) by(`tab-${panel}`).onclick = () => show(panel);

fit();
follow();
