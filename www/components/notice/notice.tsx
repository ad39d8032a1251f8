// A failure, said once, with its code and place; can be put away and blocks nothing.
import { t } from '../../messages/messages.ts';
import type { Notice as NoticeData } from '../../state.ts';
import { Icon } from '../icon/icon.tsx';
import './notice.css';

export function Notice({ notice, onDismiss }: { readonly notice: NoticeData; onDismiss(): void }) {
  const { code, message, where } = notice;
  return (
    <div class="notice" role="alert">
      <p class="notice-message">{message === '' ? t('notice.unknown') : sentence(message)}</p>
      <p class="notice-detail">
        <code>{code}</code>
        {where !== '' && <span class="notice-where">{where}</span>}
      </p>
      <button type="button" class="quiet" aria-label={t('notice.dismiss')} onClick={onDismiss}>
        <Icon name="close" size={18} />
      </button>
    </div>
  );
}

// The engine's messages follow a code and a colon elsewhere and start in lower case.
const sentence = (message: string): string => {
  const text = message.charAt(0).toUpperCase() + message.slice(1);
  return /[.!?…]$/.test(text) ? text : `${text}.`;
};
