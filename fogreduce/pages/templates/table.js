"use strict";
// Sorting and filtering of the table of runs; the points of the figures follow. Without it the page is whole too.
(function () {
  const table = document.getElementById("runs-table");
  const body = table.tBodies[0];
  const rows = Array.from(table.tBodies).flatMap((part) => Array.from(part.rows));
  const form = document.querySelector("form.controls");
  const words = document.getElementById("words");
  const state = document.getElementById("state");
  const column = Array.from(table.tHead.rows[0].cells).findIndex((header) => header.id === "of-table");
  const turned = document.getElementById("table");
  const shown = document.getElementById("shown");
  const texts = rows.map((row) => row.textContent.toLowerCase());
  const runs = [...rows];  // in order of date, as the figures have them
  const order = new Map(rows.map((row, place) => [row, place]));
  const points = runs.map(() => []);
  const runOf = new Map();
  for (const group of document.querySelectorAll("figure.chart [data-r]")) {
    const entries = group.dataset.r.split(" ").map(Number);
    Array.from(group.children).forEach((point, place) => {
      points[entries[place]].push(point);
      runOf.set(point, runs[entries[place]]);
    });
  }

  // Of a cell its number: as it begins, or as data-v has it where the text is no plain number.
  function numberOf(cell) {
    return parseFloat(cell.dataset.v || cell.textContent.replace("−", "-"));
  }

  function sort(header, column) {
    const down = header.getAttribute("aria-sort") === "ascending";
    const numeric = header.classList.contains("n");
    const key = (cell) => (numeric ? numberOf(cell) : cell.textContent);
    const keys = new Map(rows.map((row) => [row, key(row.cells[column])]));
    const missing = (value) => (numeric ? Number.isNaN(value) : value === "");
    rows.sort((one, other) => {
      const a = keys.get(one), b = keys.get(other);
      // What is missing stays at the end either way.
      if (missing(a) || missing(b)) return missing(a) - missing(b) || order.get(one) - order.get(other);
      const by = numeric ? a - b : a.localeCompare(b, "en", { numeric: true });
      return (down ? -by : by) || order.get(one) - order.get(other);
    });
    whole();
    body.append(...rows);
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", down ? "descending" : "ascending");
  }

  Array.from(table.tHead.rows[0].cells).forEach((header, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...header.childNodes);
    button.addEventListener("click", () => sort(header, column));
    header.append(button);
  });

  // A long table begins with its first rows: laying out all of them takes seconds.
  function whole() {
    table.classList.remove("first");
  }

  function filter() {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let number = 0;
    for (const row of rows) {
      const text = texts[order.get(row)];
      const fits = wanted.every((word) => text.includes(word)) &&
        (!state.value || row.cells[1].textContent === state.value) &&
        (!turned || !turned.value || row.cells[column].textContent === turned.value);
      number += fits;
      if (row.hidden === !fits) continue;
      row.hidden = !fits;
      for (const point of points[order.get(row)]) point.classList.toggle("off", !fits);
    }
    shown.textContent = number + " of " + rows.length + " runs shown";
  }

  form.addEventListener("input", () => { whole(); filter(); });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => { whole(); setTimeout(filter); });
  form.hidden = false;
  filter();
  if (table.tBodies[1]) shown.textContent = "first " + body.rows.length + " of " + rows.length + " runs shown";

  // A point names its run under the pointer, and leads to its page.
  for (const figure of document.querySelectorAll("figure.chart")) {
    figure.addEventListener("pointerover", (event) => {
      const point = event.target, row = runOf.get(point);
      if (!row || point.firstChild) return;
      const title = document.createElementNS("http://www.w3.org/2000/svg", "title");
      title.textContent = [0, 1, column - 1].map((place) => row.cells[place].textContent).join(", ");
      point.append(title);
    });
    figure.addEventListener("click", (event) => {
      const row = runOf.get(event.target), link = row && row.querySelector("a");
      if (link) link.click();
    });
  }
})();
