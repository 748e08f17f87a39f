// Where the focus goes with a new place: to its heading, so that the keyboard begins there and its name is read out.

const kPatience = 4000; // [ms] for a heading that waits for the service

/** Returns what ends the wait. Whoever goes somewhere else by themselves meanwhile is left alone. */
export function arriveAt(place: HTMLElement): () => void {
  place.focus({ preventScroll: true });
  const tryHeading = () => {
    const heading = place.querySelector('h1');
    const isElsewhere = document.activeElement !== place && document.activeElement !== document.body;
    if (heading && !isElsewhere) {
      heading.tabIndex = -1;
      heading.focus({ preventScroll: true });
    }
    if (heading || isElsewhere) stop();
  };
  const observer = new MutationObserver(tryHeading);
  // The page before is there until this turn of the script ends.
  const start = setTimeout(() => {
    observer.observe(place, { childList: true, subtree: true });
    tryHeading();
  });
  const end = setTimeout(() => stop(), kPatience);
  const stop = () => {
    observer.disconnect();
    clearTimeout(start);
    clearTimeout(end);
  };
  return stop;
}
