// The way back out of a flow that was opened in place.
import { ChevronRight, CornerLeftUp } from "lucide-react";
import { useCommands } from "../ui/commands";
import { Link } from "../ui/link";
import { navigate, paths } from "../ui/router";
import { readVia, viaText } from "./via";

export function Crumbs({ via }: { via: string }) {
  const opened = readVia(via);
  const last = opened.at(-1);
  const path = (index: number) => {
    const o = opened[index];
    return o ? paths.compose(o.name, o.flow, o.step, viaText(opened.slice(0, index))) : "";
  };
  useCommands(
    last
      ? [
          {
            title: `Back to ${last.name}`,
            group: "Document",
            icon: CornerLeftUp,
            keys: "U",
            words: "up out of module",
            run: () => navigate(path(opened.length - 1)),
          },
        ]
      : [],
  );
  if (!last) return null;
  return (
    <nav className="crumbs" aria-label="Opened from">
      {opened.map((o, i) => (
        <span key={i} className="row" style={{ gap: "var(--space-3)" }}>
          <Link href={path(i)} className="cut" title={`${o.step} of ${o.name}`}>
            {o.flow && o.flow !== o.name ? `${o.name} / ${o.flow}` : o.name}
          </Link>
          <ChevronRight size={13} className="faint" />
        </span>
      ))}
    </nav>
  );
}
