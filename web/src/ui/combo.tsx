// A text field that offers values while somebody types; any text may be typed. It is done by Enter, Tab or leaving it.
import { useEffect, useId, useLayoutEffect, useMemo, useRef, useState } from "react";
import { createPortal } from "react-dom";
import { score } from "./picker";
import "./combo.css";

export interface Choice {
  value: string;
  label?: string;
  use?: string;
  group?: string;
}

export function Combo(props: {
  value: string; label: string; placeholder?: string; choices: readonly Choice[]; onChange: (value: string) => void; className?: string; disabled?: boolean; autoFocus?: boolean;
}) {
  const [typed, setTyped] = useState(props.value);
  const [open, setOpen] = useState(false);
  const [active, setActive] = useState(-1);
  const [changed, setChanged] = useState(false);
  const input = useRef<HTMLInputElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const id = useId();
  useEffect(() => setTyped(props.value), [props.value]);
  const shown = useMemo(() => {
    if (!open) return [];
    if (!changed) return props.choices.slice(0, 60);
    return props.choices
      .map((choice) => ({ choice, score: score({ title: choice.value.replace(/^[\w-]+:/, ""), words: `${choice.value} ${choice.label ?? ""}` }, typed) }))
      .filter((entry) => entry.score > 0)
      .sort((a, b) => b.score - a.score)
      .slice(0, 60)
      .map((entry) => entry.choice);
  }, [open, changed, typed, props.choices]);

  const [place, setPlace] = useState<React.CSSProperties>({});
  useLayoutEffect(() => {
    if (!open || !input.current) return;
    const box = input.current.getBoundingClientRect();
    const foot = input.current.closest("dialog")?.querySelector(".sheet-foot")?.getBoundingClientRect().top; // its buttons stay seen
    const below = (foot ?? window.innerHeight) - box.bottom;
    const width = Math.max(box.width, 250);
    const left = Math.min(box.left, window.innerWidth - width - 8);
    setPlace(below > 240 || below > box.top ? { left, width, top: box.bottom + 3, maxHeight: Math.min(260, below - 12) } : { left, width, bottom: window.innerHeight - box.top + 3, maxHeight: Math.min(260, box.top - 12) });
  }, [open, shown.length]);
  useEffect(() => void list.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" }), [active]);

  const finish = (value: string) => {
    setOpen(false);
    setActive(-1);
    setChanged(false);
    setTyped(value);
    if (value !== props.value) props.onChange(value);
  };
  const keys = (event: React.KeyboardEvent) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      if (!open) return setOpen(true);
      const step = event.key === "ArrowDown" ? 1 : -1;
      setActive((at) => (at + step + shown.length) % Math.max(1, shown.length));
    } else if (event.key === "Enter") {
      event.preventDefault();
      finish(shown[active]?.value ?? typed.trim());
    } else if (event.key === "Escape") {
      if (!open && typed === props.value) return;
      event.preventDefault();
      event.stopPropagation();
      setTyped(props.value);
      setOpen(false);
      setChanged(false);
    } else if (event.key === "Tab") finish(shown[active]?.value ?? typed.trim());
  };
  return (
    <>
      <input
        ref={input} className={`field small ${props.className ?? ""}`} role="combobox" aria-expanded={open} aria-controls={id} aria-autocomplete="list" aria-label={props.label} title={props.label}
        aria-activedescendant={active >= 0 ? `${id}-${active}` : undefined} value={typed} placeholder={props.placeholder} disabled={props.disabled} spellCheck={false} autoComplete="off" autoFocus={props.autoFocus}
        onChange={(e) => (setTyped(e.target.value), setChanged(true), setOpen(true), setActive(-1))} onFocus={(e) => e.target.select()} onClick={() => setOpen(true)} onKeyDown={keys} onBlur={() => finish(typed.trim())}
      />
      {open && shown.length > 0 && createPortal(
        <div className="combo-list" role="listbox" id={id} aria-label={props.label} ref={list} style={place} onMouseDown={(e) => e.preventDefault()}>
          {shown.map((choice, i) => (
            <div key={choice.value} role="presentation">
              {!changed && choice.group && choice.group !== shown[i - 1]?.group && <div className="combo-group" role="presentation">{choice.group}</div>}
              <div id={`${id}-${i}`} role="option" aria-selected={i === active} className="combo-item" onMouseMove={() => i !== active && setActive(i)} onClick={() => finish(choice.value)}>
                <span className="mono cut">{choice.value}</span>
                <span className="combo-use cut">{choice.label && choice.label.toLowerCase() !== choice.value.replace(/^[\w-]+:/, "").toLowerCase() ? choice.label : choice.use}</span>
              </div>
            </div>
          ))}
        </div>,
        input.current?.closest("dialog") ?? document.body, // a modal dialog lies above all else of the page
      )}
    </>
  );
}
