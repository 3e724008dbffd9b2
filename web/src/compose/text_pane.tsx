// The text beside the canvas.
import { useEffect, useRef } from "react";
import type { Finding } from "./findings";
import type { Session } from "./session";
import { showFindings } from "./text_setup";

export function TextPane(props: {
  session: Session;
  findings: readonly Finding[];
  onFix: (finding: Finding) => void;
  onCaret: (offset: number) => void;
}) {
  const { session, findings, onFix } = props;
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    place.current?.append(session.view.dom);
    session.view.requestMeasure();
    return () => session.view.dom.remove();
  }, [session]);
  useEffect(() => showFindings(session.view, findings, onFix), [session, findings, onFix]);
  return (
    <div
      className="text-pane"
      ref={place}
      onClick={() => props.onCaret(session.view.state.selection.main.head)}
      onKeyUp={(e) => e.key.startsWith("Arrow") && props.onCaret(session.view.state.selection.main.head)}
    />
  );
}
