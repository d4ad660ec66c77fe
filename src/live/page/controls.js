// Sliders, wells, boxes and menus, made of what the metadata of parameters says.

const linear = (s) => (s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4);
const encoded = (x) => {
  const c = Math.min(1, Math.max(0, x));
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
};
const hex = (rgb) => "#" + rgb.map((x) => Math.round(255 * encoded(x)).toString(16).padStart(2, "0")).join("");
const unhex = (text) => [1, 3, 5].map((k) => round(linear(parseInt(text.slice(k, k + 2), 16) / 255)));
const round = (x) => Number(Number(x).toPrecision(4));

const make = (tag, kind, text) => {
  const element = document.createElement(tag);
  if (kind) element.className = kind;
  if (text !== undefined) element.textContent = text;
  return element;
};

// The newest value of each knob goes out while none is on its way.
const flying = new Map();
export async function send(path, body, key = path) {
  if (flying.has(key)) return void flying.set(key, body);
  flying.set(key, null);
  let next = body;
  while (next) {
    try {
      await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(next) });
    } catch { /* the page says that velour is gone */ }
    next = flying.get(key);
    if (next) flying.set(key, null);
  }
  flying.delete(key);
}

// The ends of a slider: what metadata says, softly first, else what the value suggests.
function ends(param) {
  const m = param.meta;
  const of = (...names) => names.map((name) => m[name]).find((x) => typeof x === "number");
  const now = Math.abs(param.value?.[0] ?? 0);
  const above = now <= 1 ? 1 : param.type === "int" ? Math.max(10, 2 * now) : 2 * now;
  let low = of("softmin", "slidermin", "UImin", "min");
  let high = of("softmax", "slidermax", "UImax", "max");
  if (high === undefined) high = low !== undefined && low >= above ? low + 1 : param.type === "int" && now <= 1 ? 10 : above;
  if (low === undefined) low = (param.value?.[0] ?? 0) < 0 ? -above : Math.min(0, high - 1);
  return [low, high];
}

const clamped = (x, m) => Math.min(m.max ?? Infinity, Math.max(m.min ?? -Infinity, x));

function number(param, changed) {
  const [low, high] = ends(param);
  const row = make("div", "row");
  const slider = make("input");
  // Some hundreds of steps of round numbers.
  const step = param.type === "int" ? 1 : 10 ** Math.floor(Math.log10((high - low) / 200));
  Object.assign(slider, { type: "range", min: low, max: high, step, ariaLabel: param.name });
  slider.dataset.name = param.name;
  const box = make("input");
  Object.assign(box, { type: "number", step: param.type === "int" ? 1 : "any", ariaLabel: param.name });
  const tidy = (x) => (param.type === "int" ? Math.round(x) : round(x));
  slider.oninput = () => { box.value = tidy(slider.value); changed([tidy(slider.value)]); };
  box.onchange = () => {
    if (box.value === "" || !isFinite(box.value)) return;
    const x = clamped(tidy(box.value), param.meta);
    slider.value = box.value = x;
    changed([x]);
  };
  row.append(slider, box);
  return [row, (value) => { if (document.activeElement !== box) box.value = round(value[0]); slider.value = value[0]; }];
}

function triple(param, changed) {
  const row = make("div", "row three");
  const boxes = [0, 1, 2].map(() => Object.assign(make("input"), { type: "number", step: "any", ariaLabel: param.name }));
  const well = param.type === "color" ? Object.assign(make("input"), { type: "color", ariaLabel: param.name }) : null;
  const now = () => boxes.map((box) => clamped(Number(box.value) || 0, param.meta));
  // Light above 1 keeps its strength; a well chooses the color of it.
  let strength = 1;
  const paint = (value) => { strength = Math.max(1, ...value); if (well) well.value = hex(value.map((x) => x / strength)); };
  boxes.forEach((box) => (box.onchange = () => { paint(now()); changed(now()); }));
  if (well) {
    well.oninput = () => {
      const value = unhex(well.value).map((x) => round(x * strength));
      value.forEach((x, k) => (boxes[k].value = x));
      changed(value);
    };
    row.append(well);
  }
  row.append(...boxes);
  return [row, (value) => {
    value.forEach((x, k) => { if (document.activeElement !== boxes[k]) boxes[k].value = round(x); });
    if (document.activeElement !== well) paint(value);
  }];
}

function check(param, changed) {
  const row = make("div", "row");
  const box = Object.assign(make("input"), { type: "checkbox", ariaLabel: param.name });
  box.onchange = () => changed([box.checked ? 1 : 0]);
  row.append(box);
  return [row, (value) => (box.checked = value[0] !== 0)];
}

// "a|b|c" are texts, or numbers from 0; "name:value|name:value" says which.
function menu(param, changed) {
  const row = make("div", "row");
  const select = make("select");
  select.ariaLabel = param.name;
  const entries = param.meta.options.split("|").map((entry, k) => {
    const at = entry.lastIndexOf(":");
    const mapped = at > 0 && (param.meta.widget === "mapper" || param.type !== "string");
    const text = mapped ? entry.slice(0, at) : entry;
    return [text, mapped ? entry.slice(at + 1) : param.type === "string" ? entry : String(k)];
  });
  for (const [text, value] of entries) select.append(Object.assign(make("option", "", text), { value }));
  select.onchange = () => changed([param.type === "string" ? select.value : Number(select.value)]);
  row.append(select);
  return [row, (value) => {
    const text = String(value[0]);
    if (![...select.options].some((option) => option.value === text)) select.append(Object.assign(make("option", "", text), { value: text }));
    select.value = text;
  }];
}

function words(param, changed) {
  const row = make("div", "row");
  const box = Object.assign(make("input"), { type: "text", ariaLabel: param.name, spellcheck: false });
  box.onchange = () => changed([box.value]);
  row.append(box);
  return [row, (value) => { if (document.activeElement !== box) box.value = value[0]; }];
}

function widget(param, changed) {
  const kind = param.meta.widget;
  if (typeof param.meta.options === "string" && ["int", "float", "string"].includes(param.type)) return menu(param, changed);
  if (param.type === "string") return words(param, changed);
  const yesNo = param.type === "int" && param.meta.min === 0 && param.meta.max === 1;
  if (["boolean", "checkBox", "check"].includes(kind) || yesNo) return check(param, changed);
  return ["int", "float"].includes(param.type) ? number(param, changed) : triple(param, changed);
}

// A parameter: its name, its control, and what it is for.
function knob(param, place) {
  const box = make("div", "knob");
  const top = make("div", "top");
  const label = make("span", "label", param.meta.label ?? param.name);
  label.title = param.name;
  const undo = make("button", "undo", "↺");
  undo.title = "As the text says";
  undo.ariaLabel = `${param.name} as the text says`;
  top.append(label, make("span", "type", [param.type, param.meta.units].filter(Boolean).join(", ")), undo);
  box.append(top);
  const key = JSON.stringify([place.group, place.layer, param.name]);
  const put = (value) => send("/set", { ...place, name: param.name, value }, key);
  undo.onclick = () => put(null);
  let update = () => {};
  if (param.fed) box.append(make("div", "fixed", `from ${param.fed}`));
  else if (param.type === "matrix") box.append(make("div", "fixed", "a matrix, to be changed in the text"));
  else if (!param.value) box.append(make("div", "fixed", "computed by the shader"));
  else {
    const [row, show] = widget(param, (value) => { box.classList.add("set"); put(value); });
    box.append(row);
    update = (now) => { box.classList.toggle("set", now.set); if (now.value) show(now.value); };
  }
  if (param.meta.help) box.append(make("div", "help", param.meta.help));
  return [box, update];
}

let shape = "";
let updates = [];
const hidden = (param) => param.meta.widget === "null";

// Draws the controls of a group; where they are the same as before, only their values change.
export function draw(root, group, number) {
  const bare = group.layers.map((layer) => [layer.name, layer.shader, layer.params.map((p) => [p.name, p.type, p.meta, p.fed, !p.value])]);
  const next = JSON.stringify([number, bare]);
  if (next !== shape) {
    shape = next;
    updates = [];
    root.replaceChildren();
    group.layers.forEach((layer, k) => {
      const pages = new Map();
      layer.params.forEach((param, at) => {
        const page = param.meta.page ?? "";
        if (!hidden(param)) pages.set(page, [...(pages.get(page) ?? []), [param, at]]);
      });
      const head = make("h2", "", layer.shader);
      if (group.layers.length > 1) head.append(make("small", "", layer.name));
      root.append(head);
      if (!pages.size) root.append(make("div", "fixed", "no parameters"));
      for (const [page, params] of pages) {
        if (page) root.append(make("h2", "", page.replaceAll(".", " / ")));
        for (const [param, at] of params) {
          const [box, update] = knob(param, { group: number, layer: k });
          updates.push(() => [update, k, at]);
          root.append(box);
        }
      }
    });
  }
  for (const entry of updates) {
    const [update, k, at] = entry();
    update(group.layers[k].params[at]);
  }
}

// What was changed, as a scene would write it.
export function written(groups) {
  const lines = [];
  for (const group of groups.filter((group) => group.as === null)) {
    for (const layer of group.layers) {
      for (const param of layer.params.filter((param) => param.set)) {
        const value = param.value.map((x) => (typeof x === "string" ? JSON.stringify(x) : round(x))).join(" ");
        lines.push(`${param.type} ${param.name} ${value};  // ${group.name}`);
      }
    }
  }
  return lines.join("\n");
}
