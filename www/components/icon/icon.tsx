// Line icons on a 20-unit grid, drawn with the text's colour.

const PATHS = {
  fit: 'M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4M7.5 8.6 10 7.2l2.5 1.4v2.8L10 12.8l-2.5-1.4Z',
  wireframe: 'M10 2.8 17.5 16h-15ZM6.3 9.4h7.4L10 16Z',
  compare: 'M10 2.5v15M8 5H3.5v10H8M12 5h4.5v10H12',
  split: 'M10 2.5v15M6.8 7 3.5 10l3.3 3M13.2 7l3.3 3-3.3 3',
  options: 'M3 6h6M13 6h4M3 14h3M10 14h7M11 4v4M8 12v4',
  play: 'M6.5 4v12l9-6Z',
  pause: 'M7 4.5v11M13 4.5v11',
  sun: 'M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7ZM10 1.8v1.7M10 16.5v1.7M1.8 10h1.7M16.5 10h1.7M4.2 4.2l1.2 1.2M14.6 14.6l1.2 1.2M15.8 4.2l-1.2 1.2M5.4 14.6l-1.2 1.2',
  moon: 'M16.5 11.8A7 7 0 1 1 8.2 3.5a5.6 5.6 0 0 0 8.3 8.3Z',
  system: 'M2.8 4h14.4v9.5H2.8ZM7 16.8h6M10 13.5v3.3',
  open: 'M10 13V4M6.5 7.2 10 3.8l3.5 3.4M3.5 12.5v3.7h13v-3.7',
  folder: 'M2.8 15.5V4.8h5l1.8 2.1h7.6v8.6Z',
  download: 'M10 3.5V12M6.2 8.6 10 12.4l3.8-3.8M3.5 16.2h13',
  undo: 'M4 8h8a4 4 0 1 1 0 8H8M7.2 4.6 3.8 8l3.4 3.4',
  redo: 'M16 8H8a4 4 0 1 0 0 8h4M12.8 4.6 16.2 8l-3.4 3.4',
  sliders: 'M6 3v5M6 12v5M14 3v1.5M14 8.5V17M4 10h4M12 6.5h4',
  details: 'M4 16V9M10 16V4M16 16v-5',
  help: 'M7.4 7.6a2.7 2.7 0 1 1 3.9 2.4c-.9.5-1.3 1-1.3 2M10 15v.1',
  brush: 'M16.8 3.2l-6.6 7.2M9.8 10.2c-2-.7-3.9.5-4.2 2.7-.2 1.5-1 2.4-2.4 2.9 2.6 1.2 6.4.7 7.5-1.9.6-1.5.2-2.9-.9-3.7Z',
  close: 'M5 5l10 10M15 5 5 15',
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name, size = 20 }: { name: IconName; size?: number }) {
  return (
    <svg
      class="icon"
      width={size}
      height={size}
      viewBox="0 0 20 20"
      fill="none"
      stroke="currentColor"
      stroke-width="1.6"
      stroke-linecap="round"
      stroke-linejoin="round"
      aria-hidden="true"
    >
      <path d={PATHS[name]} />
    </svg>
  );
}
