"use strict";
// Sorting: by a click on a column's head, or by Tab to it and Enter. Up, down, and the file's own order again.
const collator = new Intl.Collator("en", { numeric: true });

function numberIn(text) {
  if (text.includes("∞")) return Infinity;
  const found = /[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?|[-+−]?2\^-?\d+/i.exec(text);
  return found ? Number(found[0].replace("−", "-")) : NaN;
}

function compare(one, other, isNumber) {
  if (!isNumber) return collator.compare(one.key, other.key);
  return one.key - other.key || 0; // two infinities differ by NaN
}

function sortBy(header) {
  const row = header.parentElement;
  const column = Array.prototype.indexOf.call(row.children, header);
  const body = row.parentElement.parentElement.tBodies[0];
  const isNumber = header.classList.contains("number");
  const now = header.getAttribute("aria-sort");
  const next = now === "ascending" ? "descending" : now === "descending" ? null : "ascending";
  for (const other of row.children) other.removeAttribute("aria-sort");
  if (next) header.setAttribute("aria-sort", next);
  const rows = Array.from(body.rows);
  rows.forEach((line, index) => { if (!line.dataset.place) line.dataset.place = index; });
  rows.sort((one, other) => one.dataset.place - other.dataset.place);
  if (next) {
    const sign = next === "ascending" ? 1 : -1;
    const keyed = rows.map((line) => {
      const text = line.cells[column].textContent.trim();
      return { line, key: isNumber ? numberIn(text) : text };
    });
    // What has no value stays at the end, whichever way the others are sorted.
    const isEmpty = (one) => one.key === "" || one.key === "—" || Number.isNaN(one.key);
    const full = keyed.filter((one) => !isEmpty(one));
    full.sort((one, other) => sign * compare(one, other, isNumber));
    body.append(...full.concat(keyed.filter(isEmpty)).map((one) => one.line));
  } else {
    body.append(...rows);
  }
}

document.addEventListener("click", (event) => {
  const header = event.target.closest("th");
  if (header && event.target.closest("button")) sortBy(header);
});

// Raw rows: unpacked here where the browser can; else the link gives the compressed file.
async function unpack(link) {
  const bytes = Uint8Array.from(atob(link.href.split(",")[1]), (letter) => letter.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(plain, { headers: { "Content-Type": "text/csv" } }).blob();
}

if (typeof DecompressionStream !== "undefined") {
  for (const link of document.querySelectorAll("a.csv")) {
    link.textContent = link.download.replace(/\.gz$/, "");
    link.addEventListener("click", async (event) => {
      event.preventDefault();
      const save = document.createElement("a");
      save.href = URL.createObjectURL(await unpack(link));
      save.download = link.textContent;
      save.click();
      setTimeout(() => URL.revokeObjectURL(save.href), 60000);
    });
  }
}

// Beside the page the contents stay open; above it they would push down what was found.
document.querySelector("nav details").open = matchMedia("screen and (min-width: 75rem)").matches;

// In print everything is open, and afterwards as it was. A link into a folded table opens it.
let opened = [];
addEventListener("beforeprint", () => {
  opened = Array.from(document.querySelectorAll("details:not([open])"));
  for (const folded of opened) folded.open = true;
});
addEventListener("afterprint", () => {
  for (const folded of opened) folded.open = false;
  opened = [];
});
