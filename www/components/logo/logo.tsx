// The mark: one triangle whose corner is still fine while the rest is already coarse.
import './logo.css';

/** `size` in CSS pixels. */
export function Logo({ size = 30 }: { size?: number }) {
  return (
    <svg class="logo" width={size} height={size} viewBox="0 0 32 32" aria-hidden="true">
      <path d="M16 3.5 22.2 14.6H9.8ZM22.6 16.2 29 27.6H16.6ZM15.3 26.6 9.7 16.6H21ZM8.4 16.8 11 21.4H5.9ZM12.1 22.8 14.8 27.6H9.5ZM5 22.8 7.6 27.6H2.3ZM8.5 26.2 6.7 22.8H10.2Z" />
    </svg>
  );
}
