// A failure, said once in plain words with a way out, and exactly below; can be put away and blocks nothing.
import { t } from '../../messages/messages.ts';
import { noticeText } from '../../notices.ts';
import type { Notice as NoticeData } from '../../state.ts';
import { Icon } from '../icon/icon.tsx';
import './notice.css';

export function Notice({ notice, onDismiss }: { readonly notice: NoticeData; onDismiss(): void }) {
  const { code, message, where } = notice;
  const text = noticeText(notice);
  return (
    <div class="notice" role="alert">
      <p class="notice-message">{text}</p>
      <p class="notice-detail">
        <code>{code}</code>
        {message !== '' && message !== text && <span>{message}</span>}
        {where !== '' && <span class="notice-where">{where}</span>}
      </p>
      <button type="button" class="quiet" aria-label={t('notice.dismiss')} onClick={onDismiss}>
        <Icon name="close" size={18} />
      </button>
    </div>
  );
}
