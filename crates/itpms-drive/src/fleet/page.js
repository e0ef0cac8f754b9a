// Sorts and filters the tables of cars and drives. Without it both are there, the worst first.
"use strict";
(() => {
  const tables = [...document.querySelectorAll("table.cars, table.drives")];
  const element = (tag, cls, text) => {
    const e = document.createElement(tag);
    if (cls) e.className = cls;
    if (text != null) e.textContent = text;
    return e;
  };
  const rowsOf = (table) => [...table.tBodies[0].rows];
  const key = (row, column) => {
    const cell = row.cells[column];
    if (!cell) return "";
    const text = cell.dataset.sort ?? cell.innerText.trim();
    return text !== "" && !Number.isNaN(Number(text)) ? Number(text) : text === "–" ? "" : text;
  };
  // What is not known comes last, whichever way.
  const compared = (a, b, way) => {
    if (a === "" || b === "") return (a === "") - (b === "");
    if (typeof a === "number" && typeof b === "number") return way * (a - b);
    return way * String(a).localeCompare(String(b), undefined, { numeric: true });
  };

  for (const table of tables) {
    table.classList.add("sorts");
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      const button = element("button", "sort", head.textContent);
      button.type = "button";
      button.title = "Sort by this column";
      head.replaceChildren(button);
      button.addEventListener("click", () => {
        const way = head.ariaSort === "ascending" ? -1 : 1;
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", way > 0 ? "ascending" : "descending");
        const rows = rowsOf(table).map((row) => [key(row, column), row]);
        rows.sort((a, b) => compared(a[0], b[0], way));
        table.tBodies[0].append(...rows.map(([, row]) => row));
      });
    });
  }

  const bar = element("div", "filter"), text = element("input"), state = element("select"), count = element("output");
  text.type = "search";
  text.placeholder = "car, file or warning";
  const every = element("option", "", "every state");
  every.value = "";
  const words = [...new Set([...document.querySelectorAll("tbody .badge")].map((badge) => badge.textContent))];
  state.append(every, ...words.map((word) => element("option", "", word)));
  for (const [name, field] of [["Show only", text], ["State", state]]) {
    const label = element("label", "", name + " ");
    label.append(field);
    bar.append(label);
  }
  bar.append(count);
  const filter = () => {
    const wanted = text.value.trim().toLowerCase();
    const shown = tables.map((table) => {
      const rows = rowsOf(table);
      rows.forEach((row) => {
        const badge = row.querySelector(".badge");
        row.hidden = !(row.innerText || row.textContent).toLowerCase().includes(wanted) || (state.value !== "" && badge?.textContent !== state.value);
      });
      const left = rows.filter((row) => !row.hidden).length;
      return `${left} of ${rows.length} ${table.classList.contains("cars") ? "cars" : "drives"}`;
    });
    count.textContent = wanted || state.value ? shown.join(", ") : "";
  };
  text.addEventListener("input", filter);
  state.addEventListener("change", filter);
  if (tables.some((table) => rowsOf(table).length > 1)) document.getElementById("cars").before(bar);
})();
