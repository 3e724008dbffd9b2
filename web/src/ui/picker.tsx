// A list that is searched by typing and chosen from by keys: of commands, steps to add, steps to connect to.
import { useEffect, useId, useMemo, useRef, useState, type ReactNode } from "react";
import "./picker.css";

export interface PickerItem {
  id: string;
  title: string;
  group?: string;
  detail?: string;
  words?: string;
  icon?: ReactNode;
  end?: ReactNode;
  run: () => void;
}

// 0: no match; higher is better. Every word typed has to be found, at best where a word begins.
export function score(item: Pick<PickerItem, "title" | "words" | "detail">, typed: string): number {
  const title = item.title.toLowerCase();
  const rest = `${item.words ?? ""} ${item.detail ?? ""}`.toLowerCase();
  let total = 1;
  for (const word of typed.toLowerCase().split(/\s+/).filter(Boolean)) {
    if (title.startsWith(word)) total += 8;
    else if (new RegExp(`(^|[^\\p{L}\\p{N}])${word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}`, "u").test(title))
      total += 6;
    else if (title.includes(word)) total += 4;
    else if (rest.includes(word)) total += 1;
    else return 0;
  }
  return total;
}

const shownAtOnce = 250;

export function Picker(props: {
  label: string;
  placeholder: string;
  items: PickerItem[];
  empty: string;
  other?: (typed: string) => PickerItem | null;
  onDone: () => void;
}) {
  const [typed, setTyped] = useState("");
  const [active, setActive] = useState(0);
  const list = useRef<HTMLDivElement>(null);
  const id = useId();
  const shown = useMemo(() => {
    const found = props.items
      .map((item) => ({ item, score: score(item, typed) }))
      .filter((entry) => entry.score > 0);
    if (typed.trim() !== "") found.sort((a, b) => b.score - a.score);
    const items = found.map((entry) => entry.item);
    const other = typed.trim() === "" ? null : props.other?.(typed.trim());
    return other ? [...items.slice(0, shownAtOnce), other] : items.slice(0, shownAtOnce); // more is found by typing
  }, [props, typed]);
  const index = Math.min(active, shown.length - 1);
  useEffect(
    () => void list.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" }),
    [index, shown],
  );

  const choose = (item: PickerItem | undefined) => {
    if (!item) return;
    props.onDone();
    item.run();
  };
  const keys = (event: React.KeyboardEvent) => {
    const move = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[event.key];
    if (move !== undefined) {
      event.preventDefault();
      setActive((index + move + shown.length * 8) % Math.max(1, shown.length));
    } else if (event.key === "Enter") {
      event.preventDefault();
      choose(shown[index]);
    }
  };
  return (
    <div className="picker">
      <input
        autoFocus
        role="combobox"
        aria-expanded
        aria-controls={id}
        aria-label={props.label}
        aria-activedescendant={shown[index] ? `${id}-${index}` : undefined}
        placeholder={props.placeholder}
        value={typed}
        onChange={(e) => (setTyped(e.target.value), setActive(0))}
        onKeyDown={keys}
        spellCheck={false}
        autoComplete="off"
      />
      <div className="picker-list" role="listbox" id={id} aria-label={props.label} ref={list}>
        {shown.length === 0 && <p className="picker-empty">{props.empty}</p>}
        {shown.map((item, i) => (
          <div key={item.id} role="presentation">
            {typed.trim() === "" && item.group && item.group !== shown[i - 1]?.group && (
              <div className="picker-group" role="presentation">
                {item.group}
              </div>
            )}
            <div
              id={`${id}-${i}`}
              role="option"
              aria-selected={i === index}
              className="picker-item"
              onMouseMove={() => i !== index && setActive(i)}
              onClick={() => choose(item)}
            >
              {item.icon}
              <span className="cut">{item.title}</span>
              {item.detail && <span className="picker-detail cut">{item.detail}</span>}
              {item.end && <span className="picker-end">{item.end}</span>}
            </div>
          </div>
        ))}
      </div>
    </div>
  );
}
