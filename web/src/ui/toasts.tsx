// Short messages of what was done or could not be done; also spoken to screen readers.
import { CircleAlert, CircleCheck, X } from "lucide-react";
import { createStore } from "../api/store";

interface Toast {
  id: number;
  kind: "good" | "bad";
  title: string;
  detail: string;
  action?: { label: string; run: () => void };
}
const toasts = createStore<readonly Toast[]>([]);
const spoken = createStore("");
let nextId = 1;

export function toast(kind: Toast["kind"], title: string, detail = "", action?: Toast["action"]) {
  const id = nextId++;
  toasts.set([...toasts.get().slice(-3), { id, kind, title, detail, ...(action && { action }) }]);
  window.setTimeout(() => dismiss(id), kind === "bad" ? 9000 : 4500);
}
function dismiss(id: number) {
  toasts.set(toasts.get().filter((t) => t.id !== id));
}

// Says something to screen readers alone.
export const announce = spoken.set;

export function Toasts() {
  const shown = toasts.use();
  const words = spoken.use();
  return (
    <>
      <div className="unseen" aria-live="polite">
        {words}
      </div>
      <div className="toasts" role="status">
        {shown.map((t) => (
          <div key={t.id} className={`toast ${t.kind}`}>
            {t.kind === "good" ? <CircleCheck size={16} /> : <CircleAlert size={16} />}
            <div className="grow">
              <div style={{ fontWeight: 560 }}>{t.title}</div>
              {t.detail && (
                <div className="quiet small" style={{ whiteSpace: "pre-wrap", overflowWrap: "anywhere" }}>
                  {t.detail}
                </div>
              )}
            </div>
            {t.action && (
              <button className="button small" onClick={() => (t.action?.run(), dismiss(t.id))}>
                {t.action.label}
              </button>
            )}
            <button className="button plain icon small" aria-label="Close" onClick={() => dismiss(t.id)}>
              <X size={14} />
            </button>
          </div>
        ))}
      </div>
    </>
  );
}
