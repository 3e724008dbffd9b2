// A link on the canvas, with its kind in words, and a "+" that puts a step into it.
import { BaseEdge, EdgeLabelRenderer, getSmoothStepPath, type Edge, type EdgeProps } from "@xyflow/react";
import { Plus, Repeat2, ShieldAlert, TriangleAlert } from "lucide-react";
import { memo } from "react";
import type { Link } from "../cawl/document";
import { termWords, verbWords } from "../cawl/phrases";

export interface LinkData extends Record<string, unknown> {
  link: Link & { stale: boolean };
  onInsert?: (key: string) => void;
}
export type LinkEdgeType = Edge<LinkData, "link">;

export function whileWords(text: string): string {
  const [subject = "", verb = "", ...object] = text.trim().split(/\s+/);
  return verb ? [termWords(subject), verbWords(verb), termWords(object.join(" "))].join(" ") : text;
}

// A path that leads back up, around the right of both ends.
function backPath(x1: number, y1: number, x2: number, y2: number): [string, number, number] {
  const right = Math.max(x1, x2) + 170;
  const r = 14;
  const path = `M${x1},${y1} v${r} q0,${r} ${r},${r} H${right - r} q${r},0 ${r},${-r} V${y2 - 2 * r + r} q0,${-r} ${-r},${-r} H${x2 + r} q${-r},0 ${-r},${r} V${y2}`;
  return [path, right, (y1 + y2) / 2];
}

export const LinkEdge = memo(function LinkEdge(props: EdgeProps<LinkEdgeType>) {
  const link = props.data?.link;
  const back = props.targetY < props.sourceY + 4;
  const [path, x, y] = back
    ? backPath(props.sourceX, props.sourceY, props.targetX, props.targetY)
    : getSmoothStepPath({ ...props, borderRadius: 12, offset: 14 });
  const label =
    !link || link.kind === "plain"
      ? null
      : link.kind === "failure"
        ? "if it fails"
        : link.kind === "interrupt"
          ? "if interrupted"
          : `while ${whileWords(link.whileText)}`;
  const Icon = link?.kind === "failure" ? TriangleAlert : link?.kind === "interrupt" ? ShieldAlert : Repeat2;
  return (
    <>
      <BaseEdge
        path={path}
        interactionWidth={26}
        {...(props.markerEnd !== undefined && { markerEnd: props.markerEnd })}
      />
      <EdgeLabelRenderer>
        <div
          className={`link-label nodrag nopan${props.selected ? " selected" : ""}${label ? ` ${link?.kind}` : ""}`}
          style={{ transform: `translate(-50%, -50%) translate(${x}px, ${y}px)` }}
          data-link={link?.key}
        >
          {label && (
            <span className="link-words">
              <Icon size={11} />
              {label}
            </span>
          )}
          {link && !link.stale && props.data?.onInsert && (
            <button
              className="link-plus"
              tabIndex={-1}
              aria-label={`Put a step between ${link.from} and ${link.to}`}
              title="Put a step here"
              onClick={() => props.data?.onInsert?.(link.key)}
            >
              <Plus size={13} />
            </button>
          )}
        </div>
      </EdgeLabelRenderer>
    </>
  );
});
