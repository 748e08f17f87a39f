import './app.css';

import { mount } from 'svelte';

import App from './App.svelte';
import { beginEarly } from './shell/begin_early';
import { navigation } from './shell/navigation.svelte';

beginEarly(navigation.route);
mount(App, { target: document.body });
