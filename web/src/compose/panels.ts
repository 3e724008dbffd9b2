// Which panels are open and how wide they are, kept in this browser.
import { useState } from "react";
import { kept } from "../api/storage";

interface Panels {
  palette: boolean;
  text: boolean;
  width: number;
  tab: "canvas" | "properties" | "text"; // the one that a small window shows
}
const key = "docent.panels";

function load(): Panels {
  const usual: Panels = {
    palette: window.innerWidth > 900,
    text: false,
    width: Math.round(Math.min(520, Math.max(360, window.innerWidth * 0.34))),
    tab: "canvas",
  };
  try {
    return {
      ...usual,
      ...(JSON.parse(kept.getItem(key) ?? "{}") as Partial<Panels>),
      tab: "canvas",
      ...(window.innerWidth <= 900 && { palette: false }),
    };
  } catch {
    return usual;
  }
}

export function usePanels() {
  const [panels, setPanels] = useState(load);
  const change = (part: Partial<Panels>) =>
    setPanels((before) => {
      const after = { ...before, ...part };
      kept.setItem(key, JSON.stringify(after));
      return after;
    });
  const wide = (width: number) =>
    change({ width: Math.round(Math.max(320, Math.min(window.innerWidth - 420, width))) });
  return {
    ...panels,
    setTab: (tab: Panels["tab"]) => change({ tab }),
    toggle: (which: "palette" | "text") => change({ [which]: !panels[which] }),
    show: (which: "palette" | "text") => change({ [which]: true }),
    grip: (event: React.PointerEvent) => {
      const start = event.clientX;
      const width = panels.width;
      const move = (e: PointerEvent) => wide(width + start - e.clientX);
      const up = () => {
        window.removeEventListener("pointermove", move);
        window.removeEventListener("pointerup", up);
      };
      window.addEventListener("pointermove", move);
      window.addEventListener("pointerup", up);
      event.preventDefault();
    },
    gripKeys: (event: React.KeyboardEvent) => {
      if (event.key === "ArrowLeft") wide(panels.width + 24);
      if (event.key === "ArrowRight") wide(panels.width - 24);
    },
  };
}
