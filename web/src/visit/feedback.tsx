// How it was: stars and, if somebody likes, a few words. Told as facts.
import { Heart, Star } from "lucide-react";
import { useState } from "react";
import { rate } from "./visitor";
import { useWords } from "./words";

export function Feedback({ run, given }: { run: string; given: boolean }) {
  const { say, language } = useWords();
  const [stars, setStars] = useState(0);
  const [text, setText] = useState("");
  if (given)
    return (
      <p className="visit-thanks" role="status">
        <Heart size={18} aria-hidden />
        {say("feedback.thanks")}
      </p>
    );
  return (
    <form className="visit-feedback" onSubmit={(e) => (e.preventDefault(), rate(run, stars, text, language))}>
      <fieldset>
        <legend>{say("feedback.title")}</legend>
        <div className="visit-stars">
          {[1, 2, 3, 4, 5].map((count) => (
            <label key={count}>
              <input
                type="radio"
                name="stars"
                value={count}
                checked={stars === count}
                aria-label={say("feedback.stars", { count })}
                onChange={() => setStars(count)}
              />
              <Star size={34} aria-hidden fill={count <= stars ? "currentColor" : "none"} />
            </label>
          ))}
        </div>
      </fieldset>
      <label className="visit-text">
        {say("feedback.text")}
        <textarea rows={3} maxLength={2000} value={text} onChange={(e) => setText(e.target.value)} />
      </label>
      <button className="visit-main" disabled={stars === 0}>
        {say("feedback.send")}
      </button>
    </form>
  );
}
