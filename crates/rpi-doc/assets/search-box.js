// Search box: lists the declarations that `search` finds for the typed text. Also works for pages opened as files.
"use strict";

(() => {
  const box = document.getElementById("search");
  const list = document.getElementById("found");
  const up = document.body.dataset.up;
  let chosen = -1;

  const part = (parent, tag, text) => {
    const made = document.createElement(tag);
    made.textContent = text;
    parent.append(made);
    return made;
  };

  const show = () => {
    const rows = search(NAMES, box.value);
    list.replaceChildren();
    rows.forEach(([name, kind, module, href, about], k) => {
      const item = document.createElement("li");
      item.id = "found-" + k;
      item.setAttribute("role", "option");
      const link = part(item, "a", "");
      link.href = up + href;
      link.tabIndex = -1;
      part(link, "b", name);
      part(link, "i", kind + " of " + module);
      part(link, "span", about.replaceAll("`", ""));
      list.append(item);
    });
    if (box.value.trim() && !rows.length) part(list, "li", "no results");
    chosen = -1;
    open(Boolean(box.value.trim()));
    choose(rows.length ? 0 : -1);
  };

  const open = (is) => {
    list.hidden = !is;
    box.setAttribute("aria-expanded", String(is));
  };

  const choose = (k) => {
    const items = [...list.querySelectorAll("[role=option]")];
    if (!items.length) return box.removeAttribute("aria-activedescendant");
    chosen = (k + items.length) % items.length;
    items.forEach((item, at) => item.setAttribute("aria-selected", String(at === chosen)));
    box.setAttribute("aria-activedescendant", items[chosen].id);
    items[chosen].scrollIntoView({ block: "nearest" });
  };

  box.addEventListener("input", show);
  box.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown") choose(chosen + 1);
    else if (event.key === "ArrowUp") choose(chosen - 1);
    else if (event.key === "Enter") list.querySelector("[aria-selected=true] a")?.click();
    else if (event.key === "Escape") open(false);
    else return;
    event.preventDefault();
  });
  list.addEventListener("click", () => open(false));
  document.addEventListener("click", (event) => {
    if (!event.target.closest(".search")) open(false);
  });
  document.addEventListener("keydown", (event) => {
    const writes = event.target.closest("input, textarea");
    if (event.key !== "/" || writes || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    box.focus();
    box.select();
  });
})();
