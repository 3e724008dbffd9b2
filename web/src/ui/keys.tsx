import { keyLabels } from "./commands";

export function Keys({ keys }: { keys: string }) {
  return (
    <span className="row" style={{ gap: 3 }} aria-hidden>
      {keyLabels(keys).map((key, i) => (
        <kbd key={i}>{key}</kbd>
      ))}
    </span>
  );
}
