"use strict";
// One record or body at a time, copy and download. Without this script everything is shown.
(() => {
  const chosen = (group, value) => {
    for (const part of document.querySelectorAll("[data-choice]")) {
      const [own, at] = part.dataset.choice.split(" ");
      if (own === group) part.hidden = at !== value;
    }
    for (const other of document.querySelectorAll("select[data-choose]")) {
      if (other.dataset.choose === group) other.value = value;
    }
    document.dispatchEvent(new CustomEvent("poinsot:shown"));
  };
  for (const select of document.querySelectorAll("select[data-choose]")) {
    select.closest("label").hidden = false;
    select.addEventListener("change", () => chosen(select.dataset.choose, select.value));
    chosen(select.dataset.choose, select.value);
  }
  const save = (name, text) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const copy = async text => {
    try { await navigator.clipboard.writeText(text); return; } catch { /* Refused where the page has no focus: the old way follows. */ }
    const area = document.createElement("textarea");
    area.value = text;
    document.body.appendChild(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  };
  for (const bar of document.querySelectorAll(".export")) {
    const files = JSON.parse(bar.querySelector("script").textContent);
    const said = document.createElement("span");
    said.setAttribute("role", "status");
    const button = (text, act) => {
      const b = document.createElement("button");
      b.type = "button";
      b.textContent = text;
      b.addEventListener("click", act);
      bar.appendChild(b);
    };
    for (const f of files) button("Copy " + f.label, () => copy(f.text).then(() => { said.textContent = f.label + " copied"; }));
    for (const f of files) button("Save " + f.label, () => save(f.name, f.text));
    bar.appendChild(said);
  }
  // On paper everything is open: a closed section has no width to draw curves in.
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("details:not([open]), [data-choice][hidden]")];
    for (const part of closed) { part.removeAttribute("name"); part.open = true; part.hidden = false; }
  });
  addEventListener("afterprint", () => closed.forEach(part => { part.open = false; part.hidden = "choice" in part.dataset; }));
  document.addEventListener("toggle", () => document.dispatchEvent(new CustomEvent("poinsot:shown")), true);
  // The bytes of a page do not depend on the time; its file has a date.
  const written = new Date(document.lastModified).toISOString().slice(0, 16).replace("T", " ");
  document.querySelector("footer p").append(` File written ${written} UTC.`);
  window.poinsotSave = save;
})();
