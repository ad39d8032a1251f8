// The language of the page, each under its own name.
import { LANGUAGES, isLanguage, t } from '../../messages/messages.ts';
import type { Language } from '../../messages/messages.ts';
import './language-choice.css';

interface LanguageChoiceProps {
  readonly language: Language;
  onLanguage(language: Language): void;
}

export function LanguageChoice({ language, onLanguage }: LanguageChoiceProps) {
  return (
    <span class="language-choice">
      <span aria-hidden="true">{language.toUpperCase()}</span>
      <select
        aria-label={t('language.choose')}
        title={t('language.choose')}
        value={language}
        onChange={(event) => isLanguage(event.currentTarget.value) && onLanguage(event.currentTarget.value)}
      >
        {Object.entries(LANGUAGES).map(([value, name]) => <option key={value} value={value} lang={value}>{name}</option>)}
      </select>
    </span>
  );
}
