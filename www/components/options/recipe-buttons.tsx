// The same result without the page: a command or a program, shown and copied.
import { useState } from 'preact/hooks';
import { t } from '../../messages/messages.ts';
import { codeOf, commandOf } from '../../recipe.ts';
import type { Recipe } from '../../recipe.ts';

interface RecipeButtonsProps {
  readonly recipe: Recipe;
  onCopied(): void;
}

export function RecipeButtons({ recipe, onCopied }: RecipeButtonsProps) {
  const [kind, setKind] = useState<'command' | 'code'>('command');
  const text = kind === 'command' ? commandOf(recipe) : codeOf(recipe);
  const copy = (which: 'command' | 'code'): void => {
    setKind(which);
    void writeClipboard(which === 'command' ? commandOf(recipe) : codeOf(recipe)).then((copied) => copied && onCopied());
  };
  return (
    <>
      <p class="hint">{t('recipe.hint')}</p>
      <div class="recipe-buttons">
        <button type="button" class="secondary" onClick={() => copy('command')}>{t('recipe.command')}</button>
        <button type="button" class="secondary" onClick={() => copy('code')}>{t('recipe.code')}</button>
      </div>
      <pre class="recipe" tabindex={0} role="group" aria-label={t('options.recipe')} translate={false}><code>{text}</code></pre>
      {recipe.choices.run.paint > 0 && <p class="hint">{t('recipe.painted')}</p>}
      {recipe.choices.run.kept.length > 0 && <p class="hint">{t('recipe.kept')}</p>}
    </>
  );
}

async function writeClipboard(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Without the permission the text is there to be marked.
    return false;
  }
}
