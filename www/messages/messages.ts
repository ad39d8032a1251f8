// What the page says, in the reader's language: typed keys, plural forms and numbers by Intl, one file a language.
import { en } from './en.ts';

/** The languages there are, by the codes that browsers use, and what each calls itself. */
export const LANGUAGES = { en: 'English', de: 'Deutsch', es: 'Español', it: 'Italiano', ja: '日本語', zh: '中文' } as const;

/** A language of the page. */
export type Language = keyof typeof LANGUAGES;

/** Whether `value` is the code of one of the languages. */
export const isLanguage = (value: string): value is Language => Object.hasOwn(LANGUAGES, value);

/** The forms of a sentence with a `{count}`: which one is for which count is Intl's to say; `other` is for the rest. */
export type Forms = { readonly other: string } & Partial<Readonly<Record<Intl.LDMLPluralRule, string>>>;

/** A name of something the page says. */
export type MessageKey = keyof typeof en;

/** All that the page says, in one language: the same keys as English, with forms where English has them. */
export type Messages = { readonly [Key in MessageKey]: (typeof en)[Key] extends string ? string : Forms };

type Placeholders<Text> = Text extends `${string}{${infer Name}}${infer Rest}` ? Name | Placeholders<Rest> : never;
type ValuesOf<Message> = Message extends string ? Placeholders<Message> : Placeholders<Message[keyof Message]>;
type Arguments<Key extends MessageKey> = [ValuesOf<(typeof en)[Key]>] extends [never]
  ? []
  : [values: Readonly<Record<ValuesOf<(typeof en)[Key]>, string | number>>];

/** Keys of messages without a value to fill in. */
export type PlainKey = { [Key in MessageKey]: Arguments<Key> extends [] ? Key : never }[MessageKey];

const STORAGE_KEY = 'decimesh.language';

// English is the fallback and comes with the page; the others when they are chosen.
const LOADERS: Readonly<Record<Exclude<Language, 'en'>, () => Promise<Messages>>> = {
  de: () => import('./de.ts').then(({ de }) => de),
  es: () => import('./es.ts').then(({ es }) => es),
  it: () => import('./it.ts').then(({ it }) => it),
  ja: () => import('./ja.ts').then(({ ja }) => ja),
  zh: () => import('./zh.ts').then(({ zh }) => zh),
};

interface Current {
  readonly language: Language;
  readonly messages: Messages;
  readonly plurals: Intl.PluralRules;
}

const inUse = (language: Language, messages: Messages): Current => ({ language, messages, plurals: new Intl.PluralRules(language) });

let current = inUse('en', en);

/** The language that {@link t} speaks now. */
export const currentLanguage = (): Language => current.language;

/**
 * What the page says under `key`, with `values` in the places of its `{names}`. Numbers are written as the language
 * writes them; one called `count` decides the plural form.
 */
export function t<Key extends MessageKey>(key: Key, ...[values]: Arguments<Key>): string {
  const message: string | Forms = current.messages[key];
  const filled: Readonly<Record<string, string | number>> = values ?? {};
  const text = typeof message === 'string' ? message : formOf(message, filled['count']);
  return text.replace(/\{(\w+)\}/g, (place, name: string) => {
    const value = filled[name];
    return typeof value === 'number' ? value.toLocaleString(current.language) : (value ?? place);
  });
}

const formOf = (forms: Forms, count: string | number | undefined): string =>
  (typeof count === 'number' ? forms[current.plurals.select(count)] : undefined) ?? forms.other;

/** Speaks `language` from now on, once its messages are there; tells screen readers and the browser's fonts. */
export async function useLanguage(language: Language): Promise<void> {
  const messages = language === 'en' ? en : await LOADERS[language]();
  current = inUse(language, messages);
  document.documentElement.lang = language;
}

/** The language of an earlier visit, else the first of the browser's that the page speaks, else English. */
export function preferredLanguage(wishes: readonly string[] = navigator.languages): Language {
  const found = [remembered(), ...wishes.map((wish) => wish.toLowerCase().split('-')[0] ?? '')].find(isLanguage);
  return found ?? 'en';
}

/** Keeps the choice of `language` for the next visit. */
export function rememberLanguage(language: Language): void {
  try {
    localStorage.setItem(STORAGE_KEY, language);
  } catch {
    // Storage may be forbidden; then every visit asks the browser.
  }
}

function remembered(): string {
  try {
    return localStorage.getItem(STORAGE_KEY) ?? '';
  } catch {
    return '';
  }
}
