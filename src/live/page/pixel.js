// The closure tree, the lobes and their polar plot, of one pixel.

const COLORS = ["#e39a5b", "#6fb3d9", "#9bc56f", "#d77fb4", "#c9b458", "#8f8fe0", "#6fc7b0", "#d9776f"];
const RGB = ["#ff5a52", "#4fd16a", "#5c8cff"];

const cell = (row, text, kind) => {
  const element = row.appendChild(document.createElement("td"));
  element.textContent = text;
  if (kind) element.className = kind;
  return element;
};

export function table(root, rows, head) {
  root.replaceChildren();
  const top = root.appendChild(document.createElement("tr"));
  for (const [name, kind] of head) {
    const element = top.appendChild(document.createElement("th"));
    element.textContent = name;
    if (kind) element.className = kind;
  }
  rows.forEach((fill) => fill(root.appendChild(document.createElement("tr"))));
}

const shown = (x) => (x === 0 ? "0" : Math.abs(x) < 1e-3 || Math.abs(x) >= 1e4 ? x.toExponential(1) : String(Number(x.toPrecision(3))));

// A new line before each closure within a closure, and the names of closures marked.
function tree(root, text) {
  root.replaceChildren();
  const parts = text.split(/(\([^()]*\) \* \w+ \()/);
  let depth = 0;
  for (const part of parts) {
    const head = part.match(/^(\([^()]*\) \* )(\w+)( \()$/);
    if (!head) {
      let open = 0;
      for (const c of part) open += c === "(" ? 1 : c === ")" ? -1 : 0;
      depth += open;
      root.append(part.replaceAll("\n\t", "\n" + "  ".repeat(Math.max(0, depth))));
      continue;
    }
    const [, weight, name, open] = head;
    if (depth > 0) root.append("\n" + "  ".repeat(depth));
    const bold = document.createElement("b");
    bold.textContent = name;
    root.append(weight, bold, open);
    depth += 1;
  }
  if (!text) root.append("no closure: Ci is 0 here");
}

// Round numbers for the rings of a plot.
function rings(most) {
  const step = 10 ** Math.floor(Math.log10(most / 2));
  const unit = [1, 2, 5, 10].map((k) => k * step).find((s) => most / s <= 4) ?? 10 * step;
  const out = [];
  for (let r = unit; r <= most * 1.0001; r += unit) out.push(r);
  return out;
}

function plot(canvas, look) {
  const scale = window.devicePixelRatio || 1;
  const { clientWidth: w, clientHeight: h } = canvas;
  if (w < 80 || h < 80) return;
  canvas.width = w * scale;
  canvas.height = h * scale;
  const c = canvas.getContext("2d");
  c.scale(scale, scale);
  c.clearRect(0, 0, w, h);
  c.font = "11px system-ui, sans-serif";
  const n = look.total[0].length;
  const most = Math.max(1e-9, ...look.total.flat(), ...look.lobes.flatMap((lobe) => lobe.curve ?? []));
  const below = look.total.some((channel) => channel.some((f, k) => f > most * 1e-3 && k > n / 4 && k < (3 * n) / 4));
  const radius = below ? h / 2 - 20 : Math.min(h - 46, w / 2 - 22);
  const [x0, y0] = [w / 2, below ? h / 2 : h - 22];
  const at = (angle, r) => [x0 + Math.sin(angle) * r, y0 - Math.cos(angle) * r];
  const nothing = most <= 1e-9;
  c.lineWidth = 1;
  for (const ring of nothing ? [] : rings(most)) {
    const r = (radius * ring) / most;
    c.strokeStyle = "#343436";
    c.beginPath();
    c.arc(x0, y0, r, below ? 0 : Math.PI, 2 * Math.PI);
    c.stroke();
    c.fillStyle = "#77777c";
    c.fillText(shown(ring), x0 + r + 3 > w - 30 ? x0 + r - 26 : x0 + r - 8, y0 + 13);
  }
  c.strokeStyle = "#343436";
  for (const degrees of below ? [0, 30, 60, 120, 150, 180, 210, 240, 300, 330] : [-60, -30, 0, 30, 60]) {
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(...at((degrees * Math.PI) / 180, radius));
    c.stroke();
  }
  c.strokeStyle = "#5a5a5e";
  c.beginPath();
  c.moveTo(x0 - radius - 14, y0);
  c.lineTo(x0 + radius + 14, y0);
  c.stroke();
  const curve = (values, color, width, dash = []) => {
    c.strokeStyle = color;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    values.forEach((f, k) => {
      const [x, y] = at((2 * Math.PI * k) / n, (radius * f) / most);
      k ? c.lineTo(x, y) : c.moveTo(x, y);
    });
    c.closePath();
    c.stroke();
    c.setLineDash([]);
  };
  if (!nothing) {
    look.lobes.forEach((lobe, k) => lobe.curve && curve(lobe.curve, COLORS[k % COLORS.length], 1.5, look.lobes.length > 1 ? [4, 3] : []));
    c.globalCompositeOperation = "lighter";
    look.total.forEach((channel, k) => curve(channel, RGB[k], 1.5));
    c.globalCompositeOperation = "source-over";
  }
  // The viewer, and where a mirror would send what it sees.
  const arrow = (angle, color, text) => {
    c.strokeStyle = c.fillStyle = color;
    c.lineWidth = 1;
    c.setLineDash([2, 3]);
    c.beginPath();
    c.moveTo(...at(angle, 8));
    c.lineTo(...at(angle, radius + 6));
    c.stroke();
    c.setLineDash([]);
    const [x, y] = at(angle, radius + 10);
    c.textAlign = x < x0 - 4 ? "right" : x > x0 + 4 ? "left" : "center";
    c.fillText(text, Math.min(w - 40, Math.max(36, x)), Math.max(11, y));
    c.textAlign = "left";
  };
  arrow(-look.viewer, "#e8e8e8", "viewer");
  arrow(look.viewer, "#8a8a90", "mirror");
  c.fillStyle = "#77777c";
  c.fillText("f cos, 1/sr", 10, 18);
  if (nothing) c.fillText("nothing scatters", x0 - 40, y0 - 30);
}

export function draw(look) {
  const by = (id) => document.getElementById(id);
  plot(by("plot"), look);
  table(
    by("lobes"),
    look.lobes.map((lobe, k) => (row) => {
      const name = cell(row, lobe.closure);
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = COLORS[k % COLORS.length];
      name.prepend(swatch);
      cell(row, lobe.weight.map(shown).join("  "));
      cell(row, lobe.albedo.toFixed(3), "number");
      cell(row, lobe.through.toFixed(3), "number");
      cell(row, lobe.pick.toFixed(2), "number");
      cell(row, String(lobe.depth), "number");
    }),
    [["lobe"], ["weight"], ["albedo", "number"], ["let through", "number"], ["chosen", "number"], ["layers over it", "number"]],
  );
  tree(by("tree"), look.tree);
  if (look.emission.some((x) => x !== 0)) by("tree").append(`\nemits ${look.emission.map(shown).join("  ")}`);
  if (look.reports.length) by("tree").append("\n\n" + look.reports.join("\n"));
}

export { cell, shown };
