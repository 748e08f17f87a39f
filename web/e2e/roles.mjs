// A caller of some role, where the service itself lets everybody do everything: what is shown depends on it.

/** Answers who is signed in; to be called before the page is opened. */
export const playRole = (page, { name, role, sites = null, version = null, pictures = false }) =>
  page.route('**/api/v1/session', (route) =>
    route.request().method() === 'GET'
      ? route.fulfill({ json: { access: 'token', caller: { name, role, sites, version, pictures }, csrf: 'played' } })
      : route.fulfill({ status: 204 }),
  );
