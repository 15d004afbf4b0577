// Elements, without HTML in strings.

type Child = Node | string | number | null | undefined | false | Child[];
type Properties = Record<string, unknown>;

function append(parent: Node, child: Child): void {
  if (child === null || child === undefined || child === false) return;
  if (Array.isArray(child)) child.forEach((each) => append(parent, each));
  else parent.appendChild(child instanceof Node ? child : document.createTextNode(String(child)));
}

// An element. A property that begins with "on" is a listener, one with a "-" or "role" an attribute, any other a
// property of the element.
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K, properties: Properties = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined) continue;
    if (name.startsWith("on")) out.addEventListener(name.slice(2), value as EventListener);
    else if (name.includes("-") || name === "role" || name === "for" || name === "colspan") out.setAttribute(name, String(value));
    else (out as unknown as Properties)[name] = value;
  }
  append(out, children);
  return out;
}

export function replace(parent: Node, ...children: Child[]): void {
  parent.textContent = "";
  append(parent, children);
}

// A table; cells that are no strings are elements.
export function table(heads: string[], rows: Child[][], properties: Properties = {}): HTMLElement {
  return h("div", { className: "scroll", tabIndex: 0 },
    h("table", properties,
      h("thead", {}, h("tr", {}, heads.map((head) => h("th", { scope: "col" }, head)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, row.map((cell) => h("td", {}, cell)))))));
}

// Names and values.
export function facts(rows: [string, Child][]): HTMLElement {
  return h("dl", { className: "facts" }, rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
}

// A share from 0 to 1 as a bar.
export function bar(share: number, label: string): HTMLElement {
  const out = h("meter", { min: 0, max: 1, value: Math.min(1, Math.max(0, share)), title: label });
  out.setAttribute("aria-label", label);
  return out;
}

// Passes files on that are dropped on the element.
export function takeDrops(element: HTMLElement, open: (files: File[]) => void): void {
  element.addEventListener("dragover", (event) => event.preventDefault());
  element.addEventListener("drop", (event) => {
    event.preventDefault();
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.length > 0) open(files);
  });
}
