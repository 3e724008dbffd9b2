// A modal sheet: focus stays in it, Escape and a click beside it close it, and focus goes back to where it was.
import { useEffect, useRef, type ReactNode } from "react";

export function Dialog(props: {
  label: string;
  width?: number;
  top?: boolean;
  onClose: () => void;
  children: ReactNode;
}) {
  const ref = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    const before = document.activeElement;
    ref.current?.showModal();
    (
      ref.current?.querySelector<HTMLElement>("[data-first]") ??
      ref.current?.querySelector<HTMLElement>(".sheet-body :is(input, select, textarea)")
    )?.focus(); // else the first thing that can have it
    return () => {
      if (before instanceof HTMLElement && before.isConnected) before.focus();
    };
  }, []);
  return (
    <dialog
      ref={ref}
      className="sheet"
      aria-label={props.label}
      style={{ width: props.width ?? 520, ...(props.top && { marginTop: "14vh" }) }}
      onCancel={(event) => (event.preventDefault(), props.onClose())}
      onMouseDown={(event) => event.target === ref.current && props.onClose()}
    >
      {props.children}
    </dialog>
  );
}
