import { addressOf, changeHeaders, refusalIn } from './api_client';
import { element } from './dom';
import { formatBytes } from './format';

/** A place to drop a drive log. Calls `onDone` when the service has it all. */
export function createUpload(place: HTMLElement, onDone: () => void): void {
  const status = element('p', { class: 'hint', role: 'status' }, 'ROS bag, MCAP, rosbag2 or EuRoC archive');
  const bar = element('progress', { max: '1', value: '0', hidden: true, 'aria-label': 'Upload' });
  const input = element('input', { type: 'file', id: 'upload-file', class: 'visually-hidden' });
  const label = element('label', { for: 'upload-file', class: 'drop' }, element('strong', {}, 'Add a drive'), status, bar);
  place.append(input, label);

  const send = (file: File) => {
    const request = new XMLHttpRequest(); // fetch reports no upload progress
    request.open('PUT', addressOf('put', '/api/v1/drives', { query: { filename: file.name } }));
    for (const [name, value] of Object.entries(changeHeaders())) request.setRequestHeader(name, value);
    request.upload.addEventListener('progress', (event) => {
      bar.value = event.loaded / Math.max(1, file.size);
      status.textContent = `${file.name}: ${formatBytes(event.loaded)} of ${formatBytes(file.size)}`;
    });
    const finish = (text: string, isError: boolean) => {
      bar.hidden = true;
      status.textContent = text;
      status.classList.toggle('error', isError);
      onDone();
    };
    request.addEventListener('load', () => {
      if (request.status === 201) finish(`${file.name} is in the queue`, false);
      else finish(refusalIn(request.responseText, request.status), true);
    });
    request.addEventListener('error', () => finish(`${file.name}: the connection broke off`, true));
    bar.hidden = false;
    bar.value = 0;
    status.classList.remove('error');
    request.send(file);
  };

  input.addEventListener('change', () => {
    const file = input.files?.[0];
    if (file) send(file);
    input.value = '';
  });
  label.addEventListener('dragover', (event) => {
    event.preventDefault();
    label.classList.add('over');
  });
  label.addEventListener('dragleave', () => label.classList.remove('over'));
  label.addEventListener('drop', (event) => {
    event.preventDefault();
    label.classList.remove('over');
    const file = event.dataTransfer?.files[0];
    if (file) send(file);
  });
}
