// Which plots somebody wants to see, kept in the browser.

const kKey = 'parkade.plots.hidden';

class ShownPlots {
  private hidden: readonly string[] = $state.raw(stored());

  has(key: string): boolean {
    return !this.hidden.includes(key);
  }

  toggle(key: string): void {
    this.hidden = this.has(key) ? [...this.hidden, key] : this.hidden.filter((other) => other !== key);
    localStorage.setItem(kKey, this.hidden.join(' '));
  }
}

function stored(): string[] {
  return (localStorage.getItem(kKey) ?? '').split(' ').filter((key) => key !== '');
}

export const shownPlots = new ShownPlots();
