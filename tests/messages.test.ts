// Every language says everything that English says, with the same values in it; types see to the keys.
import { describe, expect, it } from 'vitest';
import { en } from '../www/messages/en.ts';
import { de } from '../www/messages/de.ts';
import { es } from '../www/messages/es.ts';
import { it as italian } from '../www/messages/it.ts';
import { ja } from '../www/messages/ja.ts';
import { zh } from '../www/messages/zh.ts';
import { LANGUAGES, preferredLanguage, t } from '../www/messages/messages.ts';
import type { Forms } from '../www/messages/messages.ts';

const LANGUAGE_FILES = { en, de, es, it: italian, ja, zh };

const formsOf = (message: string | Forms): string[] => (typeof message === 'string' ? [message] : Object.values(message));
const placeholders = (text: string): string[] => [...new Set(text.match(/\{\w+\}/g))].sort();

describe.each(Object.entries(LANGUAGE_FILES))('the messages in %s', (language, messages) => {
  it('have the keys of English and no empty text', () => {
    expect(Object.keys(messages).sort()).toEqual(Object.keys(en).sort());
    for (const [key, message] of Object.entries<string | Forms>(messages)) {
      for (const text of formsOf(message)) expect(text.trim(), key).not.toBe('');
    }
  });

  it('take the values that English takes', () => {
    for (const [key, message] of Object.entries<string | Forms>(messages)) {
      const [wanted = []] = formsOf((en as Record<string, string | Forms>)[key] ?? '').map(placeholders).slice(-1);
      for (const text of formsOf(message)) expect(placeholders(text), `${language} ${key}`).toEqual(wanted);
    }
  });

  it('have the plural forms that the language has for whole numbers below a million', () => {
    const plurals = new Intl.PluralRules(language);
    const needed = new Set([0, 1, 2, 3, 5, 11, 21, 100, 1000].map((count) => plurals.select(count)));
    for (const [key, message] of Object.entries<string | Forms>(messages)) {
      if (typeof message !== 'string') expect(Object.keys(message), key).toEqual(expect.arrayContaining([...needed]));
    }
  });

  it('is a language that can be chosen', () => {
    expect(Object.keys(LANGUAGES)).toContain(language);
  });
});

describe('a message', () => {
  it('has its values, numbers as the language writes them, and the form for its count', () => {
    expect(t('status.opening', { name: 'vase.glb' })).toBe('Opening vase.glb…');
    expect(t('status.ready', { count: 1 })).toBe('Ready. 1 triangle.');
    expect(t('status.ready', { count: 12_345 })).toBe('Ready. 12,345 triangles.');
    expect(t('status.showing', { shown: 1, count: 2000 })).toBe('Ready. Showing 1 of 2,000 triangles.');
    expect(t('status.opening', { name: '$& {name}' })).toBe('Opening $& {name}…');
  });
});

describe('the language to start with', () => {
  it('is the first of the browser’s that there is, whatever the region, else English', () => {
    expect(preferredLanguage(['fr-CA', 'pt', 'de-AT', 'en'])).toBe('de');
    expect(preferredLanguage(['zh-Hant-TW'])).toBe('zh');
    expect(preferredLanguage(['fr'])).toBe('en');
    expect(preferredLanguage([])).toBe('en');
  });
});
