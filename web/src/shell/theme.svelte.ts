// Light or dark, as the system has it unless somebody chose.

export type Theme = 'system' | 'light' | 'dark';
const kKey = 'parkade.theme';

class ThemeState {
  chosen: Theme = $state(stored());

  choose(theme: Theme): void {
    this.chosen = theme;
    localStorage.setItem(kKey, theme);
    this.apply();
  }

  apply(): void {
    if (this.chosen === 'system') delete document.documentElement.dataset['theme'];
    else document.documentElement.dataset['theme'] = this.chosen;
  }
}

function stored(): Theme {
  const theme = localStorage.getItem(kKey);
  return theme === 'light' || theme === 'dark' ? theme : 'system';
}

export const themeState = new ThemeState();
